// SPDX-License-Identifier: Apache-2.0
#include "aircraft/texture_file/picture_formats.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>

#include "foundation/base/error.h"

namespace airtruth::texture_file {
namespace {

using Rgba = std::array<std::uint8_t, 4>;

// Microsoft, "Bitmap Storage": a file header of 14 bytes, an information header, a palette, and
// rows from the bottom up (from the top down where the height is negative), each filled up to four
// bytes; little-endian, blue first.

constexpr std::size_t kFileHeaderBytes = 14;
constexpr std::uint32_t kInfoHeaderBytes = 40;   // the least that states a compression
constexpr std::uint32_t kAlphaHeaderBytes = 56;  // the least that states where alpha is
constexpr std::uint32_t kRgb = 0, kBitFields = 3;

}  // namespace

Picture read_bmp(std::string_view bytes, const PictureLimits& limits) {
  const auto byte = [&](std::size_t at) {
    if (at >= bytes.size()) throw Error("is a BMP file that ends early");
    return static_cast<std::uint8_t>(bytes[at]);
  };
  const auto number = [&](std::size_t at) {
    return byte(at) | std::uint32_t{byte(at + 1)} << 8 | std::uint32_t{byte(at + 2)} << 16 |
           std::uint32_t{byte(at + 3)} << 24;
  };
  const std::uint32_t header_bytes = number(kFileHeaderBytes);
  if (header_bytes < kInfoHeaderBytes)
    throw Error("is a BMP file of OS/2; expected one of Windows");
  const std::size_t pixels = number(10), palette = kFileHeaderBytes + header_bytes;
  const std::uint32_t width = number(18), stated_height = number(22);
  const std::uint32_t bits = number(28) & 0xffff, compression = number(30);
  // The order of the colours in 32 bits is stated, and the usual one is read.
  const bool is_usual = compression == kBitFields && bits == 32 && number(54) == 0xff0000 &&
                        number(58) == 0xff00 && number(62) == 0xff;
  if ((compression != kRgb && !is_usual) || (bits != 8 && bits != 24 && bits != 32))
    throw Error("is a BMP file of " + std::to_string(bits) + " bits with compression " +
                std::to_string(compression) + "; expected 8, 24 or 32 bits without");
  const bool has_alpha = is_usual && header_bytes >= kAlphaHeaderBytes && number(66) == 0xff000000;
  const bool from_top = (stated_height >> 31) != 0;
  const std::uint32_t height = from_top ? ~stated_height + 1 : stated_height;
  Picture picture = blank_picture(width, height, limits);
  const std::size_t stride = (std::size_t{width} * bits / 8 + 3) / 4 * 4;
  for (std::uint32_t y = 0; y < height; ++y)
    for (std::uint32_t x = 0; x < width; ++x) {
      const std::size_t row = from_top ? height - 1 - y : y;
      std::size_t at = pixels + row * stride + std::size_t{x} * bits / 8;
      if (bits == 8) at = palette + std::size_t{4} * byte(at);
      const Rgba colour{
          byte(at + 2), byte(at + 1), byte(at), has_alpha ? byte(at + 3) : std::uint8_t{255}};
      std::copy(colour.begin(), colour.end(), &picture.rgba[4 * (std::size_t{y} * width + x)]);
    }
  return picture;
}

namespace {

// The SGI Image File Format 0.97 (Paul Haeberli): big-endian, channels one after another, rows from
// the bottom up.

constexpr std::size_t kSgiHeaderBytes = 512;

class SgiReader {
 public:
  SgiReader(std::string_view bytes, const PictureLimits& limits) : bytes_(bytes) {
    if (bytes.size() < kSgiHeaderBytes) fail("ends inside its header");
    run_length_ = byte(2) == 1;
    bytes_per_sample_ = byte(3);
    if (byte(2) > 1 || bytes_per_sample_ < 1 || bytes_per_sample_ > 2)
      fail("has an unknown storage or sample size");
    const std::uint32_t dimensions = word(4);
    const std::uint32_t height = dimensions >= 2 ? word(8) : 1;
    channels_ = dimensions >= 3 ? word(10) : 1;
    if (dimensions < 1 || dimensions > 3 || channels_ < 1 || channels_ > 4 || long_word(104) != 0)
      fail("has no 1 to 4 plain channels");
    picture_ = blank_picture(word(6), height, limits);
  }

  Picture read() {
    for (std::uint32_t channel = 0; channel < channels_; ++channel)
      for (int y = 0; y < picture_.height; ++y)
        run_length_ ? read_runs(channel, y) : read_verbatim(channel, y);
    spread_channels();
    return std::move(picture_);
  }

 private:
  [[noreturn]] static void fail(const std::string& what) {
    throw Error("is an SGI picture with a fault: it " + what);
  }
  std::uint32_t byte(std::size_t at) const {
    if (at >= bytes_.size()) fail("ends inside its pixels");
    return static_cast<unsigned char>(bytes_[at]);
  }
  std::uint32_t word(std::size_t at) const { return byte(at) << 8 | byte(at + 1); }
  std::uint32_t long_word(std::size_t at) const { return word(at) << 16 | word(at + 2); }

  // The upper byte of a sample of 16 bits.
  std::uint8_t sample(std::size_t at) const {
    if (bytes_per_sample_ == 2) (void)byte(at + 1);
    return static_cast<std::uint8_t>(byte(at));
  }
  std::size_t row_number(std::uint32_t channel, int y) const {
    return std::size_t{channel} * static_cast<std::size_t>(picture_.height) +
           static_cast<std::size_t>(y);
  }
  std::uint8_t& pixel(std::uint32_t channel, int x, int y) {
    return picture_
        .rgba[4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(picture_.width) +
                   static_cast<std::size_t>(x)) +
              channel];
  }

  void read_verbatim(std::uint32_t channel, int y) {
    std::size_t at = kSgiHeaderBytes + row_number(channel, y) *
                                           static_cast<std::size_t>(picture_.width) *
                                           bytes_per_sample_;
    for (int x = 0; x < picture_.width; ++x, at += bytes_per_sample_)
      pixel(channel, x, y) = sample(at);
  }

  // Runs of one row: the low 7 bits count, the 8th says that the samples follow one by one.
  void read_runs(std::uint32_t channel, int y) {
    const std::size_t row = row_number(channel, y);
    std::size_t at = long_word(kSgiHeaderBytes + 4 * row);
    int x = 0;
    while (x < picture_.width) {
      const std::uint32_t control = bytes_per_sample_ == 2 ? word(at) : byte(at);
      at += bytes_per_sample_;
      const int count = static_cast<int>(control & 0x7f);
      if (count == 0) fail("has a row that ends early");
      if (count > picture_.width - x) fail("has a row that is too long");
      const bool literal = (control & 0x80) != 0;
      for (int i = 0; i < count; ++i) {
        pixel(channel, x++, y) = sample(at);
        if (literal) at += bytes_per_sample_;
      }
      if (!literal) at += bytes_per_sample_;
    }
  }

  // One channel is gray, two are gray and alpha.
  void spread_channels() {
    for (std::size_t i = 0; i < picture_.rgba.size(); i += 4) {
      std::uint8_t* p = &picture_.rgba[i];
      if (channels_ != 2 && channels_ != 4) p[3] = 255;
      if (channels_ == 2) p[3] = p[1];
      if (channels_ <= 2) p[1] = p[2] = p[0];
    }
  }

  std::string_view bytes_;
  bool run_length_ = false;
  std::uint32_t bytes_per_sample_ = 1;
  std::uint32_t channels_ = 1;
  Picture picture_;
};

// Truevision TGA File Format Specification 2.0: little-endian.

constexpr std::size_t kTgaHeaderBytes = 18;

struct TgaHeader {
  std::uint32_t id_bytes, kind, map_first, map_length, map_bits, width, height, bits, alpha_bits;
  bool has_map, run_length, from_right, from_top;
};

bool is_colour_depth(std::uint32_t bits) {
  return bits == 15 || bits == 16 || bits == 24 || bits == 32;
}

// Empty for a header that contradicts itself. The kind is 1 for a palette, 2 colour, 3 gray.
std::optional<TgaHeader> tga_header(std::string_view bytes) {
  if (bytes.size() < kTgaHeaderBytes) return std::nullopt;
  const auto byte = [&](std::size_t i) -> std::uint32_t {
    return static_cast<unsigned char>(bytes[i]);
  };
  const auto word = [&](std::size_t i) { return byte(i) | byte(i + 1) << 8; };
  const TgaHeader header{.id_bytes = byte(0),
                         .kind = byte(2) & 7,
                         .map_first = word(3),
                         .map_length = word(5),
                         .map_bits = byte(7),
                         .width = word(12),
                         .height = word(14),
                         .bits = byte(16),
                         .alpha_bits = byte(17) & 15,
                         .has_map = byte(1) == 1,
                         .run_length = (byte(2) & 8) != 0,
                         .from_right = (byte(17) & 16) != 0,
                         .from_top = (byte(17) & 32) != 0};
  const bool is_sound = byte(1) <= 1 && (byte(2) & ~11u) == 0 && header.kind >= 1 &&
                        header.kind <= 3 && (byte(17) & 0xc0) == 0 && header.width > 0 &&
                        header.height > 0 && (!header.has_map || is_colour_depth(header.map_bits));
  const bool fits_bytes = header.bits == 8 || header.bits == 16;
  const bool has_bits = header.kind == 1   ? header.has_map && fits_bytes
                        : header.kind == 2 ? is_colour_depth(header.bits)
                                           : fits_bytes;
  return is_sound && has_bits ? std::optional(header) : std::nullopt;
}

class TgaReader {
 public:
  TgaReader(std::string_view bytes, const TgaHeader& header, const PictureLimits& limits)
      : bytes_(bytes),
        header_(header),
        at_(kTgaHeaderBytes + header.id_bytes),
        picture_(blank_picture(header.width, header.height, limits)) {}

  Picture read() {
    if (header_.has_map)
      for (std::uint32_t i = 0; i < header_.map_length; ++i)
        map_.push_back(colour(header_.map_bits));
    const std::size_t count = picture_.rgba.size() / 4;
    if (!header_.run_length) {
      for (std::size_t i = 0; i < count; ++i) put(i, pixel());
      return std::move(picture_);
    }
    for (std::size_t i = 0; i < count;) {
      const std::uint32_t control = next();
      const std::size_t length = (control & 127) + 1;
      if (length > count - i) fail("has a run that is too long");
      const bool repeated = (control & 128) != 0;
      Rgba value = pixel();
      for (std::size_t k = 0; k < length; ++k, ++i) {
        if (!repeated && k > 0) value = pixel();
        put(i, value);
      }
    }
    return std::move(picture_);
  }

 private:
  [[noreturn]] static void fail(const std::string& what) {
    throw Error("is a TGA picture with a fault: it " + what);
  }
  std::uint32_t next() {
    if (at_ >= bytes_.size()) fail("ends inside its pixels");
    return static_cast<unsigned char>(bytes_[at_++]);
  }
  std::uint32_t next_word() {
    const std::uint32_t low = next();
    return low | next() << 8;
  }

  Rgba colour(std::uint32_t bits) {
    if (bits <= 16) {
      const std::uint32_t v = next_word();
      const auto five = [&](int shift) {
        return static_cast<std::uint8_t>(((v >> shift) & 31) * 255 / 31);
      };
      const bool clear = header_.alpha_bits == 1 && (v & 0x8000) == 0;
      return {five(10), five(5), five(0), static_cast<std::uint8_t>(clear ? 0 : 255)};
    }
    Rgba value{0, 0, 0, 255};
    for (const std::size_t c : {2u, 1u, 0u}) value[c] = static_cast<std::uint8_t>(next());
    if (bits != 32) return value;
    const auto fourth = static_cast<std::uint8_t>(next());
    if (header_.alpha_bits > 0) value[3] = fourth;  // else it states nothing
    return value;
  }

  Rgba pixel() {
    if (header_.kind == 2) return colour(header_.bits);
    if (header_.kind == 3) {
      const auto gray = static_cast<std::uint8_t>(next());
      const auto alpha = header_.bits == 16 ? static_cast<std::uint8_t>(next()) : std::uint8_t{255};
      return {gray, gray, gray, alpha};
    }
    const std::uint32_t index = header_.bits == 16 ? next_word() : next();
    if (index < header_.map_first || index - header_.map_first >= map_.size())
      fail("names a colour that its palette lacks");
    return map_[index - header_.map_first];
  }

  void put(std::size_t i, const Rgba& value) {
    std::size_t x = i % header_.width;
    std::size_t y = i / header_.width;
    if (header_.from_right) x = header_.width - 1 - x;
    if (header_.from_top) y = header_.height - 1 - y;
    std::copy(value.begin(), value.end(), &picture_.rgba[4 * (y * header_.width + x)]);
  }

  std::string_view bytes_;
  TgaHeader header_;
  std::size_t at_;
  Picture picture_;
  std::vector<Rgba> map_;
};

}  // namespace

Picture read_sgi(std::string_view bytes, const PictureLimits& limits) {
  return SgiReader(bytes, limits).read();
}

std::optional<Picture> read_tga(std::string_view bytes, const PictureLimits& limits) {
  const auto header = tga_header(bytes);
  return header ? std::optional(TgaReader(bytes, *header, limits).read()) : std::nullopt;
}

}  // namespace airtruth::texture_file
