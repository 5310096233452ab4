// SPDX-License-Identifier: Apache-2.0
// Pictures are written by libpng and libjpeg-turbo, or byte by byte from the formats' own pages;
// what is expected is the colour that was written.
#include "aircraft/texture_file/picture.h"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <png.h>
#include <turbojpeg.h>
#include <webp/encode.h>

#include "foundation/base/error.h"
#include "support/error_of.h"

namespace airtruth::texture_file {
namespace {

using Pixel = std::array<int, 4>;

Pixel at(const Picture& picture, int x, int y) {
  const std::size_t i = 4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(picture.width) +
                             static_cast<std::size_t>(x));
  return {picture.rgba[i], picture.rgba[i + 1], picture.rgba[i + 2], picture.rgba[i + 3]};
}

std::string fault_of(const std::string& bytes, const PictureLimits& limits = {}) {
  return test_support::error_of([&] { read_picture(bytes, limits); });
}

// Rows from the top down, as libpng writes them.
std::string png(int width,
                int height,
                std::uint32_t format,
                const void* pixels,
                const void* palette = nullptr,
                int colours = 0) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(width);
  image.height = static_cast<png_uint_32>(height);
  image.format = format;
  image.colormap_entries = static_cast<png_uint_32>(colours);
  png_alloc_size_t size = 0;
  png_image_write_to_memory(&image, nullptr, &size, 0, pixels, 0, palette);
  std::string bytes(size, '\0');
  png_image_write_to_memory(&image, bytes.data(), &size, 0, pixels, 0, palette);
  return bytes.substr(0, size);
}

TEST(Pictures, PngOfEveryKindIsRgbaFromTheBottom) {
  const unsigned char rgba[] = {1, 2, 3, 4, 5, 6, 7, 8};  // one column: top, bottom
  const Picture colour = read_picture(png(1, 2, PNG_FORMAT_RGBA, rgba));
  EXPECT_EQ(at(colour, 0, 0), (Pixel{5, 6, 7, 8}));
  EXPECT_EQ(at(colour, 0, 1), (Pixel{1, 2, 3, 4}));
  const unsigned char gray[] = {90};
  EXPECT_EQ(at(read_picture(png(1, 1, PNG_FORMAT_GRAY, gray)), 0, 0), (Pixel{90, 90, 90, 255}));
  const unsigned char gray_alpha[] = {90, 17};
  EXPECT_EQ(at(read_picture(png(1, 1, PNG_FORMAT_GA, gray_alpha)), 0, 0), (Pixel{90, 90, 90, 17}));
  const unsigned char palette[] = {10, 20, 30, 40, 50, 60};
  const unsigned char indices[] = {1, 0};
  const Picture mapped = read_picture(png(2, 1, PNG_FORMAT_RGB_COLORMAP, indices, palette, 2));
  EXPECT_EQ(at(mapped, 0, 0), (Pixel{40, 50, 60, 255}));
  // 16 bits a sample are linear in libpng's simple writer: full and none stay what they are.
  const std::uint16_t deep[] = {65535, 0, 65535};
  EXPECT_EQ(at(read_picture(png(1, 1, PNG_FORMAT_LINEAR_RGB, deep)), 0, 0),
            (Pixel{255, 0, 255, 255}));
  // Without its chunk gAMA the file is sRGB, as one of 8 bits.
  const std::uint16_t hundred[] = {100 * 257, 100 * 257, 100 * 257};
  std::string bytes = png(1, 1, PNG_FORMAT_LINEAR_RGB, hundred);
  bytes.erase(bytes.find("gAMA") - 4, 16);  // length, name, four bytes, sum
  EXPECT_EQ(at(read_picture(bytes), 0, 0), (Pixel{100, 100, 100, 255}));
}

TEST(Pictures, JpegIsReadWhateverItIsCalled) {
  std::vector<unsigned char> rgb(16 * 16 * 3, 0);
  for (std::size_t i = 0; i < rgb.size() / 2; i += 3) rgb[i] = 255;  // the upper half is red
  unsigned char* jpeg = nullptr;
  unsigned long size = 0;
  const tjhandle handle = tjInitCompress();
  ASSERT_EQ(tjCompress2(handle, rgb.data(), 16, 0, 16, TJPF_RGB, &jpeg, &size, TJSAMP_444, 100, 0),
            0);
  const std::string bytes(reinterpret_cast<const char*>(jpeg), size);
  tjFree(jpeg);
  tjDestroy(handle);
  const Picture picture = read_picture(bytes);
  EXPECT_NEAR(at(picture, 8, 15)[0], 255, 3);
  EXPECT_NEAR(at(picture, 8, 0)[0], 0, 3);
  EXPECT_EQ(at(picture, 8, 0)[3], 255);
  EXPECT_THAT(fault_of(bytes.substr(0, bytes.size() / 2)), testing::HasSubstr("with a fault"));
}

std::string sgi_header(int storage, int bytes_per_sample, int width, int height, int channels) {
  std::string head(512, '\0');
  const auto word = [&](std::size_t i, int value) {
    head[i] = static_cast<char>(value >> 8);
    head[i + 1] = static_cast<char>(value);
  };
  word(0, 474);
  head[2] = static_cast<char>(storage);
  head[3] = static_cast<char>(bytes_per_sample);
  word(4, 3);
  word(6, width);
  word(8, height);
  word(10, channels);
  return head;
}

std::string long_word(std::uint32_t value) {
  return {static_cast<char>(value >> 24),
          static_cast<char>(value >> 16),
          static_cast<char>(value >> 8),
          static_cast<char>(value)};
}

TEST(Pictures, SgiVerbatimAndInRuns) {
  // 2 x 1, red, green, blue one after another.
  const Picture plain =
      read_picture(sgi_header(0, 1, 2, 1, 3) + std::string("\x01\x02\x03\x04\x05\x06"));
  EXPECT_EQ(at(plain, 0, 0), (Pixel{1, 3, 5, 255}));
  EXPECT_EQ(at(plain, 1, 0), (Pixel{2, 4, 6, 255}));
  // 16 bits: the upper byte; two channels are gray and alpha.
  const Picture deep = read_picture(sgi_header(0, 2, 1, 1, 2) + std::string("\x40\x01\x80\x02", 4));
  EXPECT_EQ(at(deep, 0, 0), (Pixel{0x40, 0x40, 0x40, 0x80}));
  // One row of 5: three times 7, then 8 and 9 one by one.
  const std::string runs = sgi_header(1, 1, 5, 1, 1) + long_word(520) + long_word(6) +
                           std::string("\x03\x07\x82\x08\x09\x00", 6);
  const Picture row = read_picture(runs);
  EXPECT_EQ(at(row, 2, 0)[0], 7);
  EXPECT_EQ(at(row, 4, 0)[2], 9);
  // A run that goes over the row's end, a row that ends early, a table that points outside.
  std::string longer = runs;
  longer[520] = '\x7f';
  EXPECT_THAT(fault_of(longer), testing::HasSubstr("too long"));
  std::string shorter = runs;
  shorter[520] = '\0';
  EXPECT_THAT(fault_of(shorter), testing::HasSubstr("ends early"));
  std::string outside = runs;
  outside[512] = '\x7f';
  EXPECT_THAT(fault_of(outside), testing::HasSubstr("ends inside its pixels"));
}

std::string tga_header(int kind, int width, int height, int bits, int descriptor) {
  std::string head(18, '\0');
  head[2] = static_cast<char>(kind);
  head[12] = static_cast<char>(width);
  head[13] = static_cast<char>(width >> 8);
  head[14] = static_cast<char>(height);
  head[15] = static_cast<char>(height >> 8);
  head[16] = static_cast<char>(bits);
  head[17] = static_cast<char>(descriptor);
  return head;
}

TEST(Pictures, TgaOfColourGrayAndPalette) {
  // From the bottom left, blue first.
  const Picture colour = read_picture(tga_header(2, 1, 2, 24, 0) + "\x03\x02\x01\x06\x05\x04");
  EXPECT_EQ(at(colour, 0, 0), (Pixel{1, 2, 3, 255}));
  EXPECT_EQ(at(colour, 0, 1), (Pixel{4, 5, 6, 255}));
  // From the top, with alpha.
  const Picture top =
      read_picture(tga_header(2, 1, 2, 32, 0x28) + "\x03\x02\x01\x09\x06\x05\x04\x08");
  EXPECT_EQ(at(top, 0, 1), (Pixel{1, 2, 3, 9}));
  // 32 bits of which none is alpha: the fourth byte says nothing.
  const Picture opaque =
      read_picture(tga_header(2, 1, 1, 32, 0x20) + std::string("\x03\x02\x01\0", 4));
  EXPECT_EQ(at(opaque, 0, 0), (Pixel{1, 2, 3, 255}));
  // Gray in runs: three times 7, then 8.
  const Picture gray =
      read_picture(tga_header(11, 4, 1, 8, 0) + std::string("\x82\x07\x00\x08", 4));
  EXPECT_EQ(at(gray, 2, 0), (Pixel{7, 7, 7, 255}));
  EXPECT_EQ(at(gray, 3, 0), (Pixel{8, 8, 8, 255}));
  std::string palette = tga_header(1, 2, 1, 8, 0);
  palette[1] = 1;
  palette[5] = 2;
  palette[7] = 24;
  palette += std::string("\x03\x02\x01\x06\x05\x04\x01\x00", 8);
  EXPECT_EQ(at(read_picture(palette), 0, 0), (Pixel{4, 5, 6, 255}));
  palette[palette.size() - 2] = 2;
  EXPECT_THAT(fault_of(palette), testing::HasSubstr("palette lacks"));
  EXPECT_THAT(fault_of(tga_header(10, 4, 1, 8, 0)), testing::HasSubstr("no picture"));
  EXPECT_THAT(fault_of(tga_header(3, 4, 1, 8, 0) + "\x01"), testing::HasSubstr("ends inside"));
}

std::string little_endian(std::uint32_t value) {
  return {static_cast<char>(value),
          static_cast<char>(value >> 8),
          static_cast<char>(value >> 16),
          static_cast<char>(value >> 24)};
}

// A file header, an information header of 40 bytes and `more`; `height` is below 0 from the top.
std::string bmp(int width, int height, int bits, int compression, const std::string& more) {
  const std::size_t pixels = more.size() - 8;  // two pixels, each filled up to four bytes
  return "BM" + std::string(8, '\0') + little_endian(static_cast<std::uint32_t>(54 + pixels)) +
         little_endian(40) + little_endian(static_cast<std::uint32_t>(width)) +
         little_endian(static_cast<std::uint32_t>(height)) +
         little_endian(static_cast<std::uint32_t>(1 | bits << 16)) +
         little_endian(static_cast<std::uint32_t>(compression)) + std::string(20, '\0') + more;
}

TEST(Pictures, BmpOfColourAndPalette) {
  // One column of two pixels, blue first, from the bottom.
  const std::string two("\x03\x02\x01\x00\x06\x05\x04\x00", 8);
  const Picture up = read_picture(bmp(1, 2, 24, 0, two));
  EXPECT_EQ(at(up, 0, 0), (Pixel{1, 2, 3, 255}));
  EXPECT_EQ(at(up, 0, 1), (Pixel{4, 5, 6, 255}));
  const Picture down = read_picture(bmp(1, -2, 32, 0, two));
  EXPECT_EQ(at(down, 0, 0), (Pixel{4, 5, 6, 255}));
  const std::string palette("\x03\x02\x01\x00\x06\x05\x04\x00", 8);
  const Picture mapped =
      read_picture(bmp(1, 2, 8, 0, palette + std::string("\x01\0\0\0\0\0\0\0", 8)));
  EXPECT_EQ(at(mapped, 0, 0), (Pixel{4, 5, 6, 255}));
  EXPECT_EQ(at(mapped, 0, 1), (Pixel{1, 2, 3, 255}));
  EXPECT_THAT(fault_of(bmp(1, 2, 8, 1, two)), testing::HasSubstr("8 bits with compression 1"));
  EXPECT_THAT(fault_of(bmp(1, 2, 4, 0, two)), testing::HasSubstr("4 bits"));
  EXPECT_THAT(fault_of(bmp(70000, 2, 24, 0, two)), testing::HasSubstr("70000 x 2"));
  const std::string whole = bmp(1, 2, 24, 0, two);
  for (std::size_t length = 0; length + 1 < whole.size(); ++length)
    EXPECT_NE(fault_of(whole.substr(0, length)), "no error") << length;
}

TEST(Pictures, WebpKeepsItsAlpha) {
  const std::uint8_t rgba[] = {1, 2, 3, 255, 4, 5, 6, 128};  // one column: top, bottom
  std::uint8_t* webp = nullptr;
  const std::size_t size = WebPEncodeLosslessRGBA(rgba, 1, 2, 4, &webp);
  const std::string bytes(reinterpret_cast<const char*>(webp), size);
  WebPFree(webp);
  const Picture picture = read_picture(bytes);
  EXPECT_EQ(at(picture, 0, 0), (Pixel{4, 5, 6, 128}));
  EXPECT_EQ(at(picture, 0, 1), (Pixel{1, 2, 3, 255}));
  EXPECT_THAT(fault_of(bytes.substr(0, bytes.size() / 2)), testing::HasSubstr("with a fault"));
  EXPECT_THAT(fault_of(bytes, {.side_px = 1, .pixels = 9}), testing::HasSubstr("at most 1"));
}

TEST(Pictures, RefusesWhatIsNoneOrTooLarge) {
  EXPECT_THAT(fault_of(""), testing::HasSubstr("no picture that can be read"));
  EXPECT_THAT(fault_of("os.execute('touch pwned')"),
              testing::HasSubstr("PNG, JPEG, WebP, BMP, SGI or TGA"));
  EXPECT_THAT(fault_of(sgi_header(1, 1, 65535, 65535, 4)), testing::HasSubstr("65535 x 65535"));
  const unsigned char rgba[4 * 6] = {};
  const std::string file = png(3, 2, PNG_FORMAT_RGBA, rgba);
  EXPECT_EQ(fault_of(file, {.side_px = 3, .pixels = 6}), "no error");
  EXPECT_THAT(fault_of(file, {.side_px = 2, .pixels = 6}), testing::HasSubstr("at most 2"));
  EXPECT_THAT(fault_of(file, {.side_px = 3, .pixels = 5}), testing::HasSubstr("5 left"));
  // Cut anywhere before its last pixel (its last two chunks end the stream).
  for (std::size_t length = 0; length < file.size() - 24; ++length)
    EXPECT_NE(fault_of(file.substr(0, length)), "no error") << length;
}

}  // namespace
}  // namespace airtruth::texture_file
