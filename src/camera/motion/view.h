// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <optional>
#include <utility>

#include <opencv2/core.hpp>

#include "camera/lens/lens.h"
#include "foundation/geometry/transform.h"

namespace airtruth::motion {

// The directions that the pixels of a camera show, and where in its pictures corners are allowed.
class View {
 public:
  // `allowed` is 255 where corners are allowed (corners.h).
  View(lens::Lens lens, cv::Mat allowed) : lens_(std::move(lens)), allowed_(std::move(allowed)) {}

  std::optional<Vector3> bearing(const Pixel& p) const { return lens_.ray_from_pixel(p); }
  std::optional<Pixel> pixel(const Vector3& in_cam) const { return lens_.pixel_from_cam(in_cam); }
  bool is_allowed(const Pixel& p) const {
    const int x = static_cast<int>(std::floor(p.x()));
    const int y = static_cast<int>(std::floor(p.y()));
    return x >= 0 && y >= 0 && x < allowed_.cols && y < allowed_.rows &&
           allowed_.at<unsigned char>(y, x) != 0;
  }
  const cv::Mat& allowed() const { return allowed_; }
  double focal_px() const { return lens_.focal_px(); }

 private:
  lens::Lens lens_;
  cv::Mat allowed_;
};

}  // namespace airtruth::motion
