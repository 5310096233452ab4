// SPDX-License-Identifier: Apache-2.0
#include "image/picture.h"

#include <cstring>

#include "base/error.h"

namespace airtruth::image {
namespace {

Plane make_plane(int width, int height) {
  Plane plane;
  plane.width = width;
  plane.height = height;
  plane.stride = (width + 31) / 32 * 32;  // rows start where the vector units like them
  plane.samples = std::make_unique_for_overwrite<std::uint8_t[]>(
      static_cast<std::size_t>(plane.stride) * static_cast<std::size_t>(height));
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

Picture Picture::clone() const {
  Picture copy = make_picture(width, height, colour);
  for (std::size_t i = 0; i < static_cast<std::size_t>(plane_count); ++i) {
    for (int y = 0; y < planes[i].height; ++y)
      std::memcpy(
          copy.planes[i].row(y), planes[i].row(y), static_cast<std::size_t>(planes[i].width));
  }
  return copy;
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
  rgb.samples = std::make_unique<std::uint8_t[]>(static_cast<std::size_t>(width) *
                                                 static_cast<std::size_t>(height) * 3);
  return rgb;
}

}  // namespace airtruth::image
