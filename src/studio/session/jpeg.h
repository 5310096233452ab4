// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "foundation/geometry/box.h"
#include "foundation/image/picture.h"

namespace airtruth::session {

// A part of a picture as the bytes of a .jpg, `scale` times as large (0 < scale <= 1).
std::string jpeg_of(const image::Picture& picture, const PixelBox& part, double scale);
std::string jpeg_of(const image::Rgb8& rgb);

}  // namespace airtruth::session
