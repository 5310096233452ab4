// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <vector>

#include <opencv2/core.hpp>

#include "geometry/box.h"
#include "image/picture.h"

// How something small looks against what is around it. The same arithmetic for a real aircraft and
// for an inserted one, from pixels alone: no alpha, no truth.
namespace airtruth::comparison {

// A square crop about a box.
struct Patch {
  int x = 0, y = 0;    // its corner in the picture
  cv::Mat rgb;         // 8-bit
  cv::Mat grey;        // float code values
  cv::Mat silhouette;  // 8-bit, 255: differs from its surroundings
};

// The box with half its larger side around it, at least 8 px. Empty where that leaves the picture.
std::optional<Patch> patch_of(const image::Picture& picture, const Box& box);

struct Looks {
  double contrast = 0;          // mean of the silhouette less its surroundings, code values
  double edge_width_px = 0;     // 10 to 90 %, median along the outline
  double noise = 0;             // of the silhouette's inside: robust deviation of its Laplacian
  double background_noise = 0;  // the same of the surroundings
  double fine_share = 0;        // of the patch's spectrum above a quarter of the sampling rate
  double blockiness = 0;        // steps on the 8 px grid over steps off it
  double saturation = 0;        // mean of (max - min) / max over the silhouette
  std::array<double, 24> histogram{};  // 8 bins of red, green, blue, of the silhouette
};
Looks looks_of(const Patch& patch);

// Hellinger (1909) distance of two histograms, 0..1.
double distance(const std::array<double, 24>& a, const std::array<double, 24>& b);

// What a judge sees: gradient orientations by ring, noise and edge statistics; no place, no size.
std::vector<float> features_of(const Patch& patch);

}  // namespace airtruth::comparison
