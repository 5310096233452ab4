// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include <opencv2/core.hpp>

#include "foundation/geometry/box.h"
#include "foundation/geometry/transform.h"
#include "foundation/image/picture.h"

namespace airtruth::comparison {

// How the background moves from frame to frame, by phase correlation (Kuglin and Hines 1975) of
// what is fine in it, without the parts that `aircraft` covers.
class BackgroundShift {
 public:
  // Pixels; empty for the first frame and where the background shows too little.
  std::optional<Pixel> add(const image::Picture& picture, const std::vector<Box>& aircraft);

 private:
  cv::Mat before_;
};

}  // namespace airtruth::comparison
