// SPDX-License-Identifier: Apache-2.0
#include "foundation/image/picture.h"

#include <algorithm>
#include <cstring>

#include "foundation/base/error.h"

namespace airtruth::image {
namespace {

Plane make_plane(int width, int height) {
  Plane plane;
  plane.width = width;
  plane.height = height;
  plane.stride = (width + 31) / 32 * 32;  // rows begin at multiples of 32 bytes for AVX2
  plane.samples = take_samples(pixels_in(plane.stride, height));
  return plane;
}

}  // namespace

int log2_chroma_width(Chroma chroma) {
  return chroma == Chroma::k420 || chroma == Chroma::k422 ? 1 : 0;
}
int log2_chroma_height(Chroma chroma) {
  return chroma == Chroma::k420 || chroma == Chroma::k440 ? 1 : 0;
}

Picture make_picture(int width, int height, const Colour& colour) {
  check(width > 0 && height > 0, "a picture has a size");
  Picture picture;
  picture.width = width;
  picture.height = height;
  picture.colour = colour;
  picture.planes[0] = make_plane(width, height);
  picture.plane_count = 1;
  if (colour.chroma == Chroma::kNone) return picture;
  const int sx = log2_chroma_width(colour.chroma);
  const int sy = log2_chroma_height(colour.chroma);
  for (std::size_t i : {1u, 2u})
    picture.planes[i] = make_plane((width + sx) >> sx, (height + sy) >> sy);
  picture.plane_count = 3;
  return picture;
}

std::size_t Picture::bytes() const {
  std::size_t bytes = 0;
  for (const Plane& plane : planes) bytes += pixels_in(plane.stride, plane.height);
  return bytes;
}

Picture Picture::clone() const { return crop(*this, {0, 0, width, height}); }

namespace {

// The base-2 logarithm of the width of the luma plane over the width of plane i.
int log2_width(const Picture& picture, std::size_t i) {
  return i > 0 ? log2_chroma_width(picture.colour.chroma) : 0;
}
int log2_height(const Picture& picture, std::size_t i) {
  return i > 0 ? log2_chroma_height(picture.colour.chroma) : 0;
}

}  // namespace

Picture crop(const Picture& picture, const PixelBox& box) {
  check(box.x >= 0 && box.y >= 0 && box.right() <= picture.width && box.bottom() <= picture.height,
        "a crop lies inside its picture");
  check(box.x % (1 << log2_width(picture, 1)) == 0 && box.y % (1 << log2_height(picture, 1)) == 0,
        "a crop begins on a chroma sample");
  Picture part = make_picture(box.width, box.height, picture.colour);
  paste(part, picture, -box.x, -box.y);
  return part;
}

void paste(Picture& picture, const Picture& part, int x, int y) {
  check(picture.colour == part.colour, "what is pasted has the picture's colour");
  check(x % (1 << log2_width(picture, 1)) == 0 && y % (1 << log2_height(picture, 1)) == 0,
        "what is pasted begins on a chroma sample");
  for (std::size_t i = 0; i < static_cast<std::size_t>(part.plane_count); ++i) {
    const Plane& from = part.planes[i];
    Plane& to = picture.planes[i];
    const int left = x >> log2_width(picture, i);
    const int top = y >> log2_height(picture, i);
    const int first = std::max(0, left);
    const int last = std::min(to.width, left + from.width);
    if (last <= first) continue;
    for (int row = std::max(0, top); row < std::min(to.height, top + from.height); ++row)
      std::memcpy(to.row(row) + first,
                  from.row(row - top) + (first - left),
                  static_cast<std::size_t>(last - first));
  }
}

bool identical(const Picture& a, const Picture& b) {
  if (a.width != b.width || a.height != b.height || !(a.colour == b.colour)) return false;
  for (std::size_t i = 0; i < static_cast<std::size_t>(a.plane_count); ++i) {
    for (int y = 0; y < a.planes[i].height; ++y) {
      if (std::memcmp(a.planes[i].row(y),
                      b.planes[i].row(y),
                      static_cast<std::size_t>(a.planes[i].width)) != 0)
        return false;
    }
  }
  return true;
}

Rgb8 make_rgb8(int width, int height) {
  check(width > 0 && height > 0, "a picture has a size");
  Rgb8 rgb;
  rgb.width = width;
  rgb.height = height;
  rgb.samples = std::make_unique<std::uint8_t[]>(pixels_in(width, height) * 3);
  return rgb;
}

}  // namespace airtruth::image
