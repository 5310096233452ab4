// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include "aircraft/texture_file/picture_formats.h"
#include "foundation/base/error.h"

// Truevision TGA File Format Specification 2.0: little-endian.
namespace airtruth::texture_file {
namespace {

// Length of the header.
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

using Rgba = std::array<std::uint8_t, 4>;

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
    if (bits == 32) value[3] = static_cast<std::uint8_t>(next());
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

std::optional<Picture> read_tga(std::string_view bytes, const PictureLimits& limits) {
  const auto header = tga_header(bytes);
  return header ? std::optional(TgaReader(bytes, *header, limits).read()) : std::nullopt;
}

}  // namespace airtruth::texture_file
