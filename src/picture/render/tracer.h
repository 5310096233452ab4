// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "picture/render/cover.h"
#include "picture/render/ray_grid.h"
#include "picture/render/samples.h"
#include "picture/render/shade.h"

namespace airtruth::render {

// One intruder of a frame, in its own coordinates.
struct TracedIntruder {
  Placed placed;
  Matrix3 body_from_world;
  Vector3 eye_in_body;
  // Rays start at this distance, just before the sphere about the aircraft, so that float precision
  // suffices.
  double start_m = 0;
  // True where the patch's span is not an instant. The next two fields then hold the poses at its
  // three moments.
  bool moves = false;
  Thrice<Matrix3> body_from_world_at;
  Thrice<Vector3> eye_in_body_at;
  // The pixels of the frame that it can touch.
  std::optional<PixelBox> pixels;
};

// `span`: the span of the patch that contains all actors.
TracedIntruder place(const Instance& instance,
                     const View& view,
                     const Light& light,
                     const std::optional<Box>& search,
                     const Span& span);

// The pixels of the frame that a search box covers; empty where there are none.
std::optional<PixelBox> pixels_to_search(const std::optional<Box>& search, const View& view);

// A sample's direction and time.
struct Shot {
  // The time within the patch's span, from -1 to 1; 0 where that is an instant.
  Vector3 direction;
  double u = 0;  // in the patch's span; 0 where that is an instant
  double dt_s = 0;
};

// The shots of one pixel, sample by sample.
class PixelShots {
 public:
  PixelShots(const RayGrid& grid, int x, int y);
  // True where the lens has a direction at all four corners of the pixel.
  bool known() const { return known_; }
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

// True where all four directions of a pixel are known.
bool finite(const std::array<Vector3, 4>& corners);

// The sums over a pixel's samples.
struct Sum {
  // Sum over the shaded opaque samples.
  std::array<double, 3> opaque_rgb{};
  int opaque_shaded = 0;
  // Sum of the samples' alpha that opaque surfaces contribute, not yet coloured.
  double opaque = 0;
  // Sum over the shaded samples whose first surface is translucent, with the sum of their alpha.
  std::array<double, 3> translucent_rgb{};
  double translucent_shaded = 0;
  int translucent_samples_shaded = 0;
  // Sum of the alpha of all such samples.
  double translucent = 0;
  double alpha = 0;
  // Sum weighted by alpha.
  double depth = 0;
  // Smallest and largest opacity of the samples that hit.
  double least = 1;
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

struct Visible;

// Traces rays (Embree) and accumulates the surfaces that they meet.
class Tracer {
  friend class MixedPixel;

 public:
  Tracer(const Light& light,
         const std::vector<TracedIntruder>& actors,
         const RayGrid& grid,
         const SampleCounts& counts)
      : light_(light), actors_(actors), grid_(grid), counts_(counts) {}

  // Adds the samples [from, to) of a pixel to `sum`. `coverage` and `alone` hold one number for
  // each actor.
  void sample(int x, int y, int from, int to, Sum& sum, double* coverage, double* alone) const;

  // Sets the sum of a pixel in which one actor has translucent surfaces. opaque, translucent: the
  // samples that surfaces of either kind cover. A sample that opaque ones cover is opaque as a
  // whole: rays are traced through some of those, for the colour, and through all others. Returns
  // false where none of the rays hits.
  bool sample_mixed(
      int x, int y, int actor, const Cover& opaque, const Cover& translucent, Sum& sum) const;

  // Returns the sum over the samples of the share of light that this actor alone would stop, and
  // appends its surfaces to each sample's fragments. The spans have one length, up to kTogether.
  double collect(int actor,
                 std::span<const Shot> shots,
                 double pixel_rad,
                 std::span<std::vector<Fragment>> fragments) const;
  static constexpr std::size_t kTogether = 32;
  // How many times as many samples are shaded where the first surface is translucent as where it is
  // opaque: their colours differ more.
  static constexpr int kTranslucentShaded = 2;

  // Computes the light and the distance of a pixel from the surfaces that one opaque actor shows
  // there.
  void shade_visible(int x, int y, int actor, const Visible& visible, Sum& sum) const;
  // The same from the samples that are known to meet the actor, by tracing rays through some of
  // them. Returns false where none of those rays hits.
  bool shade_covered(int x, int y, int actor, const Cover& cover, Sum& sum) const;

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
  const std::vector<TracedIntruder>& actors_;
  const RayGrid& grid_;
  SampleCounts counts_;
};

}  // namespace airtruth::render
