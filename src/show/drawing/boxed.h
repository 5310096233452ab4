// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "foundation/geometry/box.h"
#include "foundation/image/picture.h"

namespace airtruth::drawing {

struct ColouredBox {
  Box box;
  std::array<std::uint8_t, 3> rgb{};
};

// The picture of a JPEG with boxes drawn on it. Each box has a dark rim, and later boxes are drawn
// over earlier ones. `scale`: pixels of the JPEG for each pixel of the boxes. Error where the bytes
// are not a JPEG.
image::Rgb8 boxed(const std::string& jpeg, double scale, const std::vector<ColouredBox>& boxes);

}  // namespace airtruth::drawing
