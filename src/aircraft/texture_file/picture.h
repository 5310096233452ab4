// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

// Texture files as plain pixels. The first bytes of a file determine its format; its name does not
// matter. The functions open no file, and they check each size that the bytes state.
namespace airtruth::texture_file {

// sRGB with straight alpha: 4 bytes per pixel (R, G, B, A), rows from the bottom up as in OpenGL.
// rgba has 4 * width * height bytes.
struct Picture {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgba;
  bool operator==(const Picture&) const = default;
};

struct PictureLimits {
  int side_px = 16384;                         // the largest texture of graphics cards
  std::size_t pixels = std::size_t{64} << 20;  // 256 MiB decoded
};

// Reads PNG (ISO/IEC 15948; gray, palette and 16 bits become 8-bit RGBA, sRGB where the file states
// no gamma), JPEG (ITU-T T.81; gray and YCbCr), WebP (RFC 9649, one picture), BMP (8, 24 and 32
// bits without compression), SGI (Haeberli's image file format 0.97; verbatim and run-length, 8 and
// 16 bits) and Truevision TGA 2.0 (types 1, 2, 3, 9, 10, 11). Throws Error, without a place, where
// the bytes have another format, are faulty or end early, or where the picture exceeds the limits.
Picture read_picture(std::string_view bytes, const PictureLimits& limits = {});

// A black picture of that size. Throws Error, which names the exceeded limit, for a larger one.
Picture blank_picture(std::uint64_t width, std::uint64_t height, const PictureLimits& limits);

}  // namespace airtruth::texture_file
