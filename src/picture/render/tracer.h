// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "picture/render/ray_grid.h"
#include "picture/render/samples.h"
#include "picture/render/shade.h"

namespace airtruth::render {

// One intruder of a frame, in its own coordinates.
struct Actor {
  Placed placed;
  Matrix3 body_from_world;
  Vector3 eye_in_body;
  // Rays begin here, just before the sphere about the aircraft, so that floats suffice.
  double start_m = 0;
  // Where the patch's span is no instant, `moves`, and the same holds at its three moments.
  bool moves = false;
  Thrice<Matrix3> body_from_world_at;
  Thrice<Vector3> eye_in_body_at;
  std::optional<PixelBox> pixels;  // where it can be in the frame
};

// `span`: of the patch that holds all actors.
Actor place(const Instance& instance,
            const View& view,
            const Light& light,
            const std::optional<Box>& search,
            const Span& span);

// The pixels of the frame that a search box asks for.
std::optional<PixelBox> pixels_to_search(const std::optional<Box>& search, const View& view);

// A sample: where it looks, and when.
struct Shot {
  Vector3 direction;  // in world, unit
  double u = 0;       // in the patch's span; 0 where that is an instant
  double dt_s = 0;
};

// The shots of one pixel, sample by sample.
class PixelShots {
 public:
  PixelShots(const RayGrid& grid, int x, int y);
  bool known() const { return known_; }  // has the lens a direction for all of the pixel?
  double pixel_rad() const { return pixel_rad_; }
  Shot operator()(int sample) const;

 private:
  PixelSamples samples_;
  Thrice<std::array<Vector3, 4>> corners_;
  bool is_instant_;
  Span span_;
  double middle_s_ = 0;
  double exposure_s_ = 0;
  bool known_ = true;
  double pixel_rad_ = 0;
};

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
                 const Shot& shot,
                 double pixel_rad,
                 std::vector<Fragment>& fragments) const;

  // Light and distance of a pixel by the samples that are known to meet one opaque actor (not 0 in
  // `is_covered`): by rays through some of those. False where none of them hits.
  bool shade_covered(
      int x, int y, int actor, const std::vector<std::int32_t>& is_covered, Sum& sum) const;

 private:
  void add(const Shot& shot,
           double pixel_rad,
           std::vector<Fragment>& fragments,
           Sum& sum,
           double* coverage) const;
  void blend(const Shot& shot,
             double pixel_rad,
             const std::vector<Fragment>& fragments,
             Sum& sum,
             double* coverage) const;
  std::array<float, 3> colour(const Shot& shot, double pixel_rad, const Fragment& fragment) const;
  float footprint(double distance_m, double pixel_rad) const;

  const Light& light_;
  const std::vector<Actor>& actors_;
  const RayGrid& grid_;
  SampleCounts counts_;
};

}  // namespace airtruth::render
