// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include <opencv2/core.hpp>

#include "foundation/geometry/box.h"
#include "foundation/geometry/transform.h"
#include "foundation/image/picture.h"

namespace airtruth::appearance {

// Measures the shift of the background from frame to frame by phase correlation (Kuglin and Hines
// 1975) of its fine detail, without the parts that `aircraft` covers.
class BackgroundShift {
 public:
  // Returns the shift in pixels; empty for the first frame and where the background has too little
  // detail.
  std::optional<Pixel> add(const image::Picture& picture, const std::vector<Box>& aircraft);

 private:
  cv::Mat before_;
};

}  // namespace airtruth::appearance
