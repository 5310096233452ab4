// SPDX-License-Identifier: Apache-2.0
#include "aircraft/texture_file/picture.h"

#include <string>

#include "aircraft/texture_file/picture_kinds.h"
#include "foundation/base/error.h"
#include "foundation/base/huge_pages.h"

namespace airtruth::aircraft {

Picture blank_picture(std::uint64_t width, std::uint64_t height, const PictureLimits& limits) {
  const auto side = static_cast<std::uint64_t>(limits.side_px);
  const std::string size = std::to_string(width) + " x " + std::to_string(height) + " pixels";
  if (width == 0 || height == 0) throw Error("is a picture of " + size + "; expected at least one");
  if (width > side || height > side || width * height > limits.pixels)
    throw Error("is a picture of " + size + "; expected at most " + std::to_string(side) +
                " on a side and " + std::to_string(limits.pixels) + " left in all");
  Picture picture;
  picture.width = static_cast<int>(width);
  picture.height = static_cast<int>(height);
  const auto bytes = static_cast<std::size_t>(width * height * 4);
  picture.rgba.reserve(bytes);
  ask_for_huge_pages(picture.rgba.data(), bytes);
  picture.rgba.resize(bytes);
  return picture;
}

Picture read_picture(std::string_view bytes, const PictureLimits& limits) {
  if (is_png(bytes)) return read_png(bytes, limits);
  if (is_jpeg(bytes)) return read_jpeg(bytes, limits);
  if (is_sgi(bytes)) return read_sgi(bytes, limits);
  if (is_tga(bytes)) return read_tga(bytes, limits);
  throw Error("is no picture that can be read; expected PNG, JPEG, SGI or TGA");
}

}  // namespace airtruth::aircraft
