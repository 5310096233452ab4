// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

namespace airtruth {

// The nearest whole number of pixels, cut at a million to either side, which is far outside any
// picture. A place or size from a file may be any number.
inline int whole_pixels(double px) {
  return static_cast<int>(std::round(std::clamp(px, -1e6, 1e6)));
}

}  // namespace airtruth
