// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "picture/render/cover.h"
#include "picture/render/pixel_light.h"
#include "picture/render/reach.h"
#include "picture/render/straight.h"
#include "picture/render/tracer.h"

// Finds the outline of an opaque aircraft without rays. Seen from the eye, a direction d lies
// within the triangle (a, b, c) where it is on the inner side of three planes, each of which
// contains the eye and one side: d . (a x b) >= 0 and so on (Olano and Greer 1997, "Triangle scan
// conversion using 2D homogeneous coordinates", eq. 1 to 4). The test holds for any lens, because d
// is the sample's own ray. Inside a pixel d is bilinear in the sample's place, and so is each
// product: the values at the four corners give it for every sample. A sample is covered where any
// triangle covers it, so no sorting by depth is needed.
//
// The samples and their coverage equal those of the rays (Tracer::sample). This method is about
// fifty times faster for a pixel with many samples.
//
// During an exposure the eye and the aircraft move, and each sample has its own time. In the
// aircraft's own frame the side from a to b does not move, and the test becomes the product of two
// lines (Pluecker 1865), with the sample's ray through the eye e along d:
//
//   d . (a x b) + (b - a) . (e x d) >= 0
//
// This test is exact at every time. Over a pixel's exposure parabolas approximate d, e x d and the
// products.
namespace airtruth::render {

class Silhouette {
 public:
  enum class Touch { kNone, kOpaque, kOpaqueByRays, kMixed, kRays };

  // Sorts the actor's triangles by the pixels of the patch that they can touch. The object keeps
  // references to `actor` and `grid`. sees: whether see() will be called.
  Silhouette(const TracedIntruder& actor,
             const View& view,
             const PixelBox& patch,
             const RayGrid& grid,
             bool sees);

  // The content of a pixel: kNone, no part of the aircraft; kOpaque, only opaque triangles, few
  // enough for cover() to be faster than rays; kOpaqueByRays, the same, but see() does not know the
  // depth of each; kMixed, opaque triangles and translucent ones; kRays, anything else.
  Touch touch(int x, int y) const;

  // Covers the samples of a pixel of the kind kOpaque. No sample is covered where the lens lacks a
  // direction for some part of the pixel. samples: a multiple of PixelSamples::kCells^2, up to
  // PixelSamples::kMost.
  void cover(int x, int y, int samples, Cover& result) const;

  // Covers the samples of a pixel of the kind kMixed by its opaque triangles and by its translucent
  // ones; of the latter Cover::triangles is known, too.
  void cover_mixed(int x, int y, int samples, Cover& opaque, Cover& translucent) const;

  // Finds the visible surfaces of a pixel of the kind kOpaque by a depth buffer over some of its
  // samples (PixelSamples::fill_cells()). Returns the number of the samples that are covered.
  int see(int x, int y, const SampleCounts& counts, Visible& visible) const;

  // Both at once, which is cheaper. Returns what see() returns.
  int cover_and_see(
      int x, int y, const SampleCounts& counts, Cover& result, Visible& visible) const;

 private:
  // The planes of a triangle through the eye. At an instant `side` holds their inward normals, in
  // world. During a motion `side` holds a x b and `edge` holds b - a for each side, in body.
  struct Planes {
    std::array<Vector3, 3> side;
    std::array<Vector3, 3> edge;
  };
  static constexpr std::uint32_t kNone = 0xffffffff;
  struct Triangle {
    std::uint32_t part = 0;
    std::uint32_t in_part = 0;
    // Where the triangle's outline is in planes_; kNone: in still_ or moving_.
    std::uint32_t planes = kNone;
    // Where its picture is in still_ or moving_, by whether the actor moves; kNone: nowhere.
    std::uint32_t picture = kNone;
    // No later triangle is nearer.
    float nearest = std::numeric_limits<float>::infinity();
    bool opaque = true;
    // As in Model::Impl.
    bool even = true;
    // A part that spins, of which only its reach is known.
    bool is_disc = false;
    bool has_depth = false;
  };

  // The vertices of one part at the moments of the eyes.
  class Vertices;
  // The rays of a pixel, as the planes use them.
  struct Pencil;
  // Marks one pixel's samples.
  class PixelCover;
  void add_part(const TracedIntruder& actor,
                std::size_t part,
                const std::vector<Eye>& eyes,
                std::vector<Reach>& reaches);
  // Finds the lines of a triangle's picture. Returns false where there are none.
  bool place(const std::vector<Corners>& corners,
             const std::vector<Eye>& eyes,
             double exposure_share,
             const Tolerance& tolerance,
             Triangle& triangle);
  // A part that spins or swings during the exposure: rays handle the pixels that it can touch.
  void add_moving_part(const TracedIntruder& actor,
                       const aircraft::Part& part,
                       const std::vector<Eye>& eyes,
                       std::vector<Reach>& reaches);
  // Adds pixels that only rays can answer for.
  void add_disc(const Reach& reach, std::vector<Reach>& reaches);
  // The rows of pixels that a triangle can touch.
  struct RowSpan {
    std::uint32_t triangle = 0;
    int y = 0;
    int x0 = 0;
    int x1 = 0;
    // In in_row_; kNone: nowhere.
    std::uint32_t in_row = kNone;
  };
  // Fills in_row_.
  std::vector<RowSpan> rows_of(const std::vector<Reach>& reaches,
                               const std::vector<std::uint32_t>& order);
  // The order in which a depth buffer tests triangles; sets Triangle::nearest.
  std::vector<std::uint32_t> nearest_first();
  // Empty where the triangle is seen edge-on.
  std::optional<Planes> planes_of(const Vertices& vertices, const aircraft::Triangle& source) const;
  Pencil pencil_of(int x, int y) const;
  bool is_known(int x, int y) const;
  void sort_by_pixel(const std::vector<Reach>& reaches);
  // A triangle over a pixel.
  struct Entry {
    std::uint32_t triangle = 0;
    // In in_row_; kNone: nowhere.
    std::uint32_t in_row = kNone;
  };
  std::span<const Entry> triangles_of(int x, int y) const;
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y - patch_.y) * static_cast<std::size_t>(patch_.width) +
           static_cast<std::size_t>(x - patch_.x);
  }

  PixelBox patch_;
  const RayGrid& grid_;
  const TracedIntruder& actor_;
  bool sees_;
  std::vector<Triangle> triangles_;
  std::vector<StillTriangle> still_;
  std::vector<MovingTriangle> moving_;
  std::vector<RowTriangle> in_row_;
  std::vector<Planes> planes_;
  // The index in by_pixel_ of each pixel's first triangle; one more entry at the end.
  std::vector<std::uint32_t> first_;
  std::vector<Entry> by_pixel_;
  std::vector<Touch> touch_;
};

}  // namespace airtruth::render
