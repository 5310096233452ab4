// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "picture/render/pixel_rays.h"
#include "picture/render/tracer.h"

// The light of a pixel that one opaque aircraft covers, from its visible surfaces.
namespace airtruth::render {

constexpr std::size_t kMostSpots = 256;

// A part of a pixel in which one triangle is visible.
struct Spot {
  // A point in its middle. Hit::t is not used.
  Hit hit;
  // The time of that point in the pixel's exposure, from 0 to 1.
  float time = 0.5f;
  // How many of the pixel's samples it stands for.
  float samples = 1;
  // One of a few that are spread evenly over the triangle's visible part; they are looked at first.
  bool leads = true;
};

// The surfaces that an aircraft shows in a pixel.
struct Visible {
  // At most kMostSpots, with those of one triangle one after another.
  std::vector<Spot> spots;
  // The number of samples over the whole pixel.
  int of_samples = 1;
};

// Where the eye is in body during the exposure of one pixel.
class PixelEye {
 public:
  PixelEye(const TracedIntruder& actor, const RayGrid& grid, int x, int y);
  PixelEye(const PixelRays& rays, bool moves);
  Vector3 at(float time) const;

 private:
  // Coefficients of 1, u and u^2, with u from -1 (beginning of the exposure) to 1.
  Thrice<Vector3> eye_;
  bool moves_ = false;
};

// Colours of equal weight, with their variance.
struct Spread {
  int count = 0;
  std::array<float, 3> sum{};
  std::array<float, 3> squares{};

  void add(const Rgb& rgb);
  void add(const Spread& other);
  // True where the standard error of the mean, times `share`, is below `tolerance` of the colour.
  bool is_known(float share, float tolerance) const;
};

// Mean colour (linear) and distance over the spots.
struct PixelLight {
  std::array<double, 3> rgb{};
  double distance_m = 0;
  // Of the spots that are looked at, each with weight 1.
  Spread spread;
};

// The sun's light and shadow and the texture are found at every spot that is looked at: first at
// those that lead, and at the others of a triangle if the standard error of the mean of the first
// is not small beside the colour. The light of the surroundings is computed once for all spots of a
// triangle, at the mean of their places: within a pixel it is smooth over a triangle. pixel_rad:
// the angle across a pixel.
PixelLight light_of(const Placed& placed,
                    const PixelEye& eye,
                    const Visible& visible,
                    const Light& light,
                    double pixel_rad);

}  // namespace airtruth::render
