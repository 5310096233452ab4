// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "camera/lens/lens.h"
#include "foundation/image/layer.h"
#include "foundation/image/picture.h"

namespace airtruth::focal_length {

// The beginning of the note in a calibration that holds such an estimate.
constexpr const char* kEstimatedNote = "estimated by airtruth lens estimate";

// Estimates the focal length of a lens without distortion from a video alone. While the camera
// turns, the angles between far points stay constant; through a wrong lens they would appear to
// change. Corners are tracked until the camera has turned by some degrees. For every candidate lens
// the rotation between the two frames is fitted (rotation_fit.h); the candidate with the least
// residual is the result.
//
// What is in view, near ground above all, moves the estimates of neighbouring turns the same way,
// by more than their noise: halves that interleave agree with one another and not with the next ten
// seconds. So the clip is cut into stretches (4 to 8, each of turns that follow one another), each
// is estimated on its own, and the uncertainty is that of one more stretch: with the standard
// deviation s of the logarithms of n estimates, the interval is the estimate times
// exp(+- t s sqrt(1 + 1/n)), where t is the 97.5 % point of Student's t with n - 1 degrees of
// freedom (the prediction interval of a further observation: Hahn and Meeker 1991, "Statistical
// Intervals", section 4.7). It takes no credit for the number of stretches, because an error that
// they share does not average out. docs/lenses.md has how often it holds the other parts of a clip.
class LensEstimator {
 public:
  // The shape of the pixels is stated by the video.
  LensEstimator(int width,
                int height,
                const image::Mask* own_aircraft = nullptr,
                double width_of_height = 1);
  ~LensEstimator();

  // Adds the next frame, in order. No corner is tracked across the begin of a shot
  // (foundation/image/cuts.h).
  void add(const image::Picture& picture, bool begins_shot = false);

  struct Result {
    bool fisheye = false;  // equidistant; else pinhole
    // All lengths count heights of pixels, as in lens::undistorted().
    double focal_px = 0;
    // The standard deviation of the estimate of a stretch about focal_px.
    double sigma_px = 0;
    // The 95 % interval, widened to all focal lengths that fit equally well, whose mean squared
    // residual is within 2 % of the least. The search ends at 0.25 and 6 widths of the picture: an
    // interval that reaches an end is open there.
    double low_px = 0;
    double high_px = 0;
    bool is_open_low = false;
    bool is_open_high = false;
    // Whether that interval is closed, and narrow enough to use focal_px as the camera's focal
    // length.
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

  // The interval in words, such as "410 to 421 px" or "1177 to 2880 px or more".
  static std::string interval_words(const Result& found, const char* unit = " px");

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace airtruth::focal_length
