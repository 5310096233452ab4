// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "camera/lens/lens.h"
#include "foundation/image/layer.h"
#include "foundation/image/picture.h"

namespace airtruth::motion {

// A lens of one number, its focal length, from a video alone: while the camera turns, far points
// keep their angles to one another, which through a wrong lens they do not. Corners are followed
// until the camera has turned by some degrees; for every candidate the rotation between the two
// frames is fitted (rotation_fit.h), and the candidate with the least left over is the lens.
class LensEstimator {
 public:
  LensEstimator(int width, int height, const image::Mask* own_aircraft = nullptr);
  ~LensEstimator();

  // Frames in order.
  // begins_shot: nothing is followed into it from the picture before (foundation/image/cuts.h).
  void add(const image::Picture& picture, bool begins_shot = false);

  struct Result {
    bool fisheye = false;  // equidistant; else pinhole
    double focal_px = 0;
    double sigma_px = 0;  // from half the pairs each
    double low_px = 0;    // every focal length from here to high_px fits as well, within 2 % of the
    double high_px = 0;  // mean squared misfit; the search ends at 0.25 and 6 widths of the picture
    bool is_certain = false;  // that interval is narrow enough to take the value as the camera's
    double rms_px = 0;        // of what is left over
    double other_rms_px = 0;  // the same of the best lens of the other kind
    int pairs = 0;
  };
  // Empty, with the reason, where the camera turned too little. An estimate that is not certain
  // comes with the reason too.
  std::optional<Result> result(std::string& why) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace airtruth::motion
