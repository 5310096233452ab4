// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>

#include <opencv2/core.hpp>

#include "foundation/geometry/box.h"
#include "foundation/geometry/transform.h"
#include "foundation/image/picture.h"

// Measures the appearance of a small object against its surroundings. The same arithmetic applies
// to a real and to an inserted aircraft, from pixels alone: it uses neither alpha nor truth.
namespace airtruth::appearance {

// A square crop about a box.
struct Patch {
  int x = 0, y = 0;  // corner in the picture, px
  cv::Mat rgb;       // 8-bit
  cv::Mat grey;      // float code values
  // 8-bit; 255 where the object, whole within the patch, stands out from its surroundings.
  cv::Mat silhouette;
};

// Crops the box with a margin of half its larger side, at least 8 px. Returns empty where the crop
// leaves the picture.
std::optional<Patch> patch_of(const image::Picture& picture, const Box& box);

// How the camera reproduces the outline of a silhouette, from profiles across the outline.
struct Outline {
  double edge_width_px = 0;  // 10 to 90 % of the step, median along the outline; 0: no clear edge
  // Overshoot of the sky beside the outline relative to the sky further off, away from the
  // aircraft, as a share of the step.
  double halo = 0;
};

struct Looks : Outline {
  double contrast = 0;  // median of the silhouette less that of its surroundings, code values
  // Of the silhouette less the plane through its surroundings, code values: the brightest and the
  // darkest pixel, and the means over the whole silhouette of what lies above and of what lies
  // below (their sum is the mean contrast). Above is 0 or more, below is 0 or less.
  double peak_above = 0, peak_below = 0, mean_above = 0, mean_below = 0;
  double noise = 0;             // of the silhouette's inside: robust deviation of its Laplacian
  double background_noise = 0;  // the same of the surroundings
  double fine_share = 0;        // of the patch's spectrum above 1/4 cycle a pixel
  double middle_share = 0;      // of it from 1/8 to 1/4 cycle a pixel
  double blockiness = 0;        // steps on the 8 px grid over steps off it
  double saturation = 0;        // mean of (max - min) / max over the silhouette
  double strongest_red = 0;     // largest Cr of it less the median Cr around, code values
  double brightest_decile = 0;  // mean of the brightest tenth of it, code values
  double longest_px = 0;        // larger side of its bounds
  Pixel centre_px{0, 0};        // of the silhouette, in the picture
  std::array<double, 24> histogram{};  // 8 bins of red, green, blue, of the silhouette
};
Looks looks_of(const Patch& patch);

// Hellinger (1909) distance of two histograms, 0..1.
double distance(const std::array<double, 24>& a, const std::array<double, 24>& b);

// `level`: the surroundings (surroundings_of()). All of one size; `grey` and `level` float.
Outline outline_of(const cv::Mat& grey, const cv::Mat& silhouette, const cv::Mat& level);

}  // namespace airtruth::appearance
