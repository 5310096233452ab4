// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "render/ray_grid.h"
#include "render/samples.h"
#include "render/shade.h"

namespace airtruth::render {

// One intruder of a frame, in its own coordinates.
struct Actor {
  Placed placed;
  Matrix3 body_from_world;
  Vector3 eye_in_body;
  // Rays begin here, just before the sphere about the aircraft, so that floats suffice.
  double start_m = 0;
  std::optional<PixelBox> pixels;  // where it can be in the frame
};

Actor place(const Instance& instance,
            const View& view,
            const Light& light,
            const std::optional<Box>& search);

// Are all four a pixel's directions known?
bool finite(const std::array<Vector3, 4>& corners);

// What a pixel's samples add up to.
struct Sum {
  std::array<double, 3> opaque_rgb{};  // of the shaded opaque samples
  int opaque_shaded = 0;
  double opaque = 0;  // samples' alpha that opaque surfaces contribute, not yet coloured
  std::array<double, 3> translucent_rgb{};
  double alpha = 0;
  double depth = 0;  // alpha-weighted
  double least = 1;  // smallest and largest opacity of the samples that hit
  double most = 0;
  int hits = 0;
  int count = 0;
};

// A surface along a sample's ray.
struct Fragment {
  double distance_m = 0;
  int actor = 0;
  float alpha = 1;
  Hit hit;
};

// Shoots rays (Embree) and gathers what they meet.
class Tracer {
 public:
  Tracer(const Light& light,
         const std::vector<Actor>& actors,
         const RayGrid& grid,
         const SampleCounts& counts)
      : light_(light), actors_(actors), grid_(grid), counts_(counts) {}

  // Adds samples [from, to) of a pixel. `coverage` and `alone`: per actor.
  void sample(int x, int y, int from, int to, Sum& sum, double* coverage, double* alone) const;

  // The share of a sample's light that one actor alone would stop; its surfaces are appended.
  double collect(int actor,
                 const Vector3& direction,
                 double pixel_rad,
                 std::vector<Fragment>& fragments) const;

  // Light and distance of a pixel by the samples that are known to meet one opaque actor (not 0 in
  // `is_covered`): by rays through some of those. False where none of them hits.
  bool shade_covered(
      int x, int y, int actor, const std::vector<std::int32_t>& is_covered, Sum& sum) const;

 private:
  void add(const Vector3& direction,
           double pixel_rad,
           std::vector<Fragment>& fragments,
           Sum& sum,
           double* coverage) const;
  void blend(const Vector3& direction,
             double pixel_rad,
             const std::vector<Fragment>& fragments,
             Sum& sum,
             double* coverage) const;
  std::array<float, 3> colour(const Vector3& direction,
                              double pixel_rad,
                              const Fragment& fragment) const;
  float footprint(double distance_m, double pixel_rad) const;

  const Light& light_;
  const std::vector<Actor>& actors_;
  const RayGrid& grid_;
  SampleCounts counts_;
};

}  // namespace airtruth::render
