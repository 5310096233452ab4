// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "foundation/image/picture.h"

namespace airtruth::drawing {

struct NamedPicture {
  std::string name;
  image::Rgb8 picture;
};

// Arranges pictures of one size in `columns` columns under a title, each with its name in its lower
// left corner.
image::Rgb8 tiled(const std::string& title, std::vector<NamedPicture> pictures, int columns);

}  // namespace airtruth::drawing
