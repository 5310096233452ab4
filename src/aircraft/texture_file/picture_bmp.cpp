// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

#include "aircraft/texture_file/picture_formats.h"
#include "foundation/base/error.h"

// Microsoft, "Bitmap Storage": a file header of 14 bytes, an information header, a palette, and
// rows from the bottom up (from the top down where the height is negative), each filled up to four
// bytes; little-endian, blue first.
namespace airtruth::texture_file {
namespace {

constexpr std::size_t kFileHeaderBytes = 14;
constexpr std::uint32_t kInfoHeaderBytes = 40;   // the least that states a compression
constexpr std::uint32_t kAlphaHeaderBytes = 56;  // the least that states where alpha is
constexpr std::uint32_t kRgb = 0, kBitFields = 3;

class BmpReader {
 public:
  BmpReader(std::string_view bytes, const PictureLimits& limits) : bytes_(bytes), limits_(limits) {}

  Picture read() {
    header();
    const std::uint32_t height = from_top_ ? ~height_ + 1 : height_;
    Picture picture = blank_picture(width_, height, limits_);
    const std::size_t stride = (std::size_t{width_} * bits_ / 8 + 3) / 4 * 4;
    for (std::uint32_t y = 0; y < height; ++y) {
      const std::size_t row = from_top_ ? height - 1 - y : y;
      for (std::uint32_t x = 0; x < width_; ++x) {
        const std::array<std::uint8_t, 4> colour =
            colour_at(pixels_ + row * stride + std::size_t{x} * bits_ / 8);
        for (std::size_t c = 0; c < 4; ++c)
          picture.rgba[4 * (std::size_t{y} * width_ + x) + c] = colour[c];
      }
    }
    return picture;
  }

 private:
  void header() {
    const std::uint32_t size = number(kFileHeaderBytes);
    if (size < kInfoHeaderBytes) throw Error("is a BMP file of OS/2; expected one of Windows");
    pixels_ = number(10);
    palette_ = kFileHeaderBytes + size;
    width_ = number(18);
    height_ = number(22);
    from_top_ = (height_ >> 31) != 0;
    bits_ = number(28) & 0xffff;
    const std::uint32_t compression = number(30);
    // The order of the colours in 32 bits is stated, and the usual one is read.
    const bool is_usual = compression == kBitFields && bits_ == 32 && number(54) == 0xff0000 &&
                          number(58) == 0xff00 && number(62) == 0xff;
    if ((compression != kRgb && !is_usual) || (bits_ != 8 && bits_ != 24 && bits_ != 32))
      throw Error("is a BMP file of " + std::to_string(bits_) + " bits with compression " +
                  std::to_string(compression) + "; expected 8, 24 or 32 bits without");
    has_alpha_ = is_usual && size >= kAlphaHeaderBytes && number(66) == 0xff000000;
  }

  std::array<std::uint8_t, 4> colour_at(std::size_t at) const {
    if (bits_ == 8) at = palette_ + std::size_t{4} * byte(at);
    return {byte(at + 2), byte(at + 1), byte(at), has_alpha_ ? byte(at + 3) : std::uint8_t{255}};
  }

  std::uint8_t byte(std::size_t at) const {
    if (at >= bytes_.size()) throw Error("is a BMP file that ends early");
    return static_cast<std::uint8_t>(bytes_[at]);
  }

  std::uint32_t number(std::size_t at) const {
    return byte(at) | std::uint32_t{byte(at + 1)} << 8 | std::uint32_t{byte(at + 2)} << 16 |
           std::uint32_t{byte(at + 3)} << 24;
  }

  std::string_view bytes_;
  PictureLimits limits_;
  std::size_t pixels_ = 0, palette_ = 0;
  std::uint32_t width_ = 0, height_ = 0, bits_ = 0;
  bool from_top_ = false, has_alpha_ = false;
};

}  // namespace

Picture read_bmp(std::string_view bytes, const PictureLimits& limits) {
  return BmpReader(bytes, limits).read();
}

}  // namespace airtruth::texture_file
