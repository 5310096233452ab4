// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "camera/lens/lens.h"
#include "foundation/image/layer.h"
#include "foundation/image/picture.h"

namespace airtruth::focal_length {

// Estimates the focal length of a lens without distortion from a video alone. While the camera
// turns, the angles between far points stay constant; through a wrong lens they would appear to
// change. Corners are tracked until the camera has turned by some degrees. For every candidate lens
// the rotation between the two frames is fitted (rotation_fit.h); the candidate with the least
// residual is the result.
class LensEstimator {
 public:
  LensEstimator(int width, int height, const image::Mask* own_aircraft = nullptr);
  ~LensEstimator();

  // Adds the next frame, in order. No corner is tracked across the begin of a shot
  // (foundation/image/cuts.h).
  void add(const image::Picture& picture, bool begins_shot = false);

  struct Result {
    bool fisheye = false;  // equidistant; else pinhole
    double focal_px = 0;
    // The uncertainty, from two estimates with one half of the pairs each.
    double sigma_px = 0;
    // Every focal length from low_px to high_px fits equally well: its mean squared residual is
    // within 2 % of the least. The search ends at 0.25 and 6 widths of the picture.
    double low_px = 0;
    double high_px = 0;
    // Whether that interval is narrow enough to use focal_px as the camera's focal length.
    bool is_certain = false;
    // The root mean square residual.
    double rms_px = 0;
    // The same for the best lens of the other kind.
    double other_rms_px = 0;
    int pairs = 0;
  };
  // The estimate. It is empty where the camera turned too little. `why` states the reason for an
  // empty result, and for an estimate that is not certain.
  std::optional<Result> result(std::string& why) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace airtruth::focal_length
