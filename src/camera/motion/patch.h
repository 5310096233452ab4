// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include <opencv2/core.hpp>

#include "foundation/geometry/transform.h"

namespace airtruth::motion {

// The side of a patch, in samples.
constexpr int kPatchPx = 16;

// The surroundings of a corner in one picture, prepared to be found in other pictures by the method
// of Lucas and Kanade (1981) in its inverse form (Baker and Matthews 2004): the slopes and the
// normal matrix are those of the patch, so they are computed once, and a search only samples the
// other picture. Samples near the rim have less weight, since what passes there often moves
// otherwise. The mean difference of luma between the two pictures is removed, so that a change
// of exposure does not move the result. All sums are integers, so the result is the same on every
// machine.
class Patch {
 public:
  // The patch whose first sample is (x, y). Empty where it or the ring of one sample around it
  // leaves the picture, and where it has too little texture in some direction.
  Patch() = default;
  static std::optional<Patch> at(const cv::Mat& grey, int x, int y);

  struct Found {
    // The position of the patch's first sample in the other picture, in samples.
    double x = 0, y = 0;
    // The root mean square of what remains between patch and picture, beside that of the patch
    // about its own mean: 0 for an equal copy, about 1.4 for unrelated texture of equal contrast.
    double unlikeness = 0;
  };
  // The place in another picture that resembles the patch, from a guess of its first sample's
  // position. Empty where the search leaves the picture or does not settle.
  std::optional<Found> find(const cv::Mat& grey, double guess_x, double guess_y) const;

 private:
  // The number of samples of a patch.
  static constexpr int kSamples = kPatchPx * kPatchPx;
  struct Difference;
  Difference difference(const cv::Mat& grey, int x_16th, int y_16th) const;

  std::array<std::int16_t, kSamples> luma_;  // in kLumaSteps a code value
  // The difference of the neighbours on either side, in code values, which is twice the slope,
  // times the weight of the sample.
  std::array<std::int16_t, kSamples> slope_x_, slope_y_;
  double mean_slope_x_ = 0, mean_slope_y_ = 0;               // weighted, of the differences
  double inverse_xx_ = 0, inverse_xy_ = 0, inverse_yy_ = 0;  // of the normal matrix of the slopes
  double contrast_ = 0;  // root mean square about the mean, in code values
};

// A picture at half, quarter, ... of its size. Level 0 shares the samples of the picture. A sample
// of level n + 1 is the mean of two by two samples of level n, so a position p in pixels of the
// picture (corner origin) is p / 2^n in samples of level n.
using Levels = std::vector<cv::Mat>;
Levels levels_of(const cv::Mat& grey);

// A patch of one level of a picture. Its positions are those of its middle, in pixels of the
// picture (corner origin).
class LevelPatch {
 public:
  // The patch around the whole sample nearest to a position. On a coarse level a patch at the rim
  // is moved inward, so that its middle is elsewhere. Empty where Patch::at() is.
  static std::optional<LevelPatch> around(const Levels& levels, int level, const Pixel& position);

  Pixel middle() const;
  // The position in another picture, from a guess. Empty where nothing similar is found.
  std::optional<Pixel> find(const Levels& levels, const Pixel& guess) const;

 private:
  LevelPatch(int level, const cv::Point& first, const Patch& patch)
      : level_(level), first_(first), patch_(patch) {}
  int level_;
  cv::Point first_;  // sample of the patch
  Patch patch_;
};

}  // namespace airtruth::motion
