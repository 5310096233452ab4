// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <utility>

#include <airtruth/picture.h>

#include "foundation/base/error.h"
#include "foundation/image/colour.h"
#include "library/pictures/public_forms.h"

namespace airtruth {
namespace {

using image::Chroma;
using image::Matrix;

constexpr std::array<std::pair<const char*, Chroma>, 5> kFormats = {{{"gray", Chroma::kNone},
                                                                     {"yuv420p", Chroma::k420},
                                                                     {"yuv422p", Chroma::k422},
                                                                     {"yuv440p", Chroma::k440},
                                                                     {"yuv444p", Chroma::k444}}};
constexpr const char* kRgbFormat = "gbrp";
constexpr std::array<std::pair<const char*, Matrix>, 4> kMatrices = {{{"rgb", Matrix::kRgb},
                                                                      {"bt601", Matrix::kBt601},
                                                                      {"bt709", Matrix::kBt709},
                                                                      {"bt2020", Matrix::kBt2020}}};

template <typename Table, typename Value>
const char* name_in(const Table& table, Value value) {
  return std::ranges::find(table, value, [](const auto& row) { return row.second; })->first;
}

template <typename Table>
auto value_in(const Table& table, const std::string& name, const char* what) {
  const auto found = std::ranges::find(table, name, [](const auto& row) { return row.first; });
  if (found == table.end())
    throw Error(std::string(what) + " is '" + name.substr(0, 80) +
                "'; expected one of <airtruth/picture.h>");
  return found->second;
}

image::Colour colour_of(const FramePicture& picture) {
  image::Colour colour;
  const bool is_rgb = picture.pixel_format == kRgbFormat;
  colour.chroma = is_rgb ? Chroma::k444 : value_in(kFormats, picture.pixel_format, "pixel_format");
  colour.matrix = value_in(kMatrices, picture.matrix, "matrix");
  if (is_rgb != (colour.matrix == Matrix::kRgb))
    throw Error("pixel_format is '" + picture.pixel_format + "' and matrix is '" + picture.matrix +
                "'; expected 'gbrp' and 'rgb' together or neither");
  colour.range = picture.is_full_range ? image::Range::kFull : image::Range::kLimited;
  return colour;
}

image::Picture picture_of(const FramePicture& from) {
  if (from.width <= 0 || from.height <= 0)
    throw Error("the picture is " + std::to_string(from.width) + "x" + std::to_string(from.height) +
                "; expected at least 1x1");
  image::Picture picture = image::make_picture(from.width, from.height, colour_of(from));
  if (std::ssize(from.planes) != picture.plane_count)
    throw Error("the picture has " + std::to_string(from.planes.size()) + " planes; expected " +
                std::to_string(picture.plane_count));
  for (std::size_t i = 0; i < from.planes.size(); ++i) {
    const SamplePlane& plane = from.planes[i];
    image::Plane& to = picture.planes[i];
    if (plane.width != to.width || plane.height != to.height ||
        plane.samples.size() != pixels_in(to.width, to.height))
      throw Error("a plane of the picture has the wrong size; expected " +
                  std::to_string(to.width) + "x" + std::to_string(to.height) + " samples");
    for (int y = 0; y < to.height; ++y) std::copy_n(plane.row(y), to.width, to.row(y));
  }
  return picture;
}

}  // namespace

FramePicture public_picture(const image::Picture& picture) {
  const image::Colour& colour = picture.colour;
  FramePicture result;
  result.width = picture.width;
  result.height = picture.height;
  result.pixel_format =
      colour.matrix == Matrix::kRgb ? kRgbFormat : name_in(kFormats, colour.chroma);
  result.matrix = name_in(kMatrices, colour.matrix);
  result.is_full_range = colour.range == image::Range::kFull;
  for (int i = 0; i < picture.plane_count; ++i) {
    const image::Plane& plane = picture.planes[static_cast<std::size_t>(i)];
    SamplePlane& to = result.planes.emplace_back();
    to.width = plane.width;
    to.height = plane.height;
    to.samples.reserve(pixels_in(plane.width, plane.height));
    for (int y = 0; y < plane.height; ++y)
      to.samples.insert(to.samples.end(), plane.row(y), plane.row(y) + plane.width);
  }
  return result;
}

std::vector<std::uint8_t> rgb_of(const FramePicture& picture) {
  const image::Rgb8 rgb = image::rgb8_from_picture(picture_of(picture));
  return {rgb.samples.get(), rgb.samples.get() + rgb.bytes().size()};
}

}  // namespace airtruth
