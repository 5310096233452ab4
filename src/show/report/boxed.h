// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "foundation/geometry/box.h"
#include "foundation/image/picture.h"

namespace airtruth::report {

struct ColouredBox {
  Box box;
  std::array<std::uint8_t, 3> rgb{};
};

// A JPEG's picture with boxes drawn on it, the first under the others and with a dark rim.
// `scale`: pixels of the JPEG for each of the boxes' own. Error where the bytes are no JPEG.
image::Rgb8 boxed(const std::string& jpeg, double scale, const std::vector<ColouredBox>& boxes);

}  // namespace airtruth::report
