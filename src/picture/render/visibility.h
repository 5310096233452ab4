// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "picture/render/coverage.h"
#include "picture/render/samples.h"

// What is visible in a pixel. The opaque triangles over it give its alpha by coverage masks
// (coverage.h), and its surfaces by 64 samples: their edge functions are tested against the samples
// (Pineda 1988, "A parallel algorithm for polygon rasterization"), nearest triangles first, and a
// visibility buffer keeps the nearest opaque one of each sample with its inverse distance (Catmull
// 1974). Translucent triangles before it are kept as fragments of the sample and blended in the
// order of their distance (the A-buffer: Carpenter 1984). Where several aircraft or an outline of a
// translucent surface meet in a pixel, more samples give alpha as well.
namespace airtruth::render {

// A place and a time in a pixel, as in Samples.
struct PixelPlace {
  float x = 0, y = 0, t = 0;
};

// A surface that is visible in a pixel.
struct VisibleSurface {
  // Of Visibility::triangle() and functions().
  std::uint32_t candidate = 0;
  // What the surface contributes to alpha, and the share of the pixel's light that nearer surfaces
  // let through to it.
  float weight = 0;
  float light = 0;
  // The mean of the samples that are read.
  PixelPlace middle;
  // Of Visibility::reads(): [first_read, end_read) are spread evenly over what is visible; at least
  // one.
  std::uint32_t first_read = 0;
  std::uint32_t end_read = 0;
};

class Visibility {
 public:
  Visibility(const RayTriangles& triangles,
             const std::vector<PlacedInstance>& instances,
             const PixelRays& rays,
             const SampleCounts& counts);

  // Sorts the triangles of a row of the patch into its pixels.
  void begin_row(int y, int x0, int x1);

  // Looks at a pixel of the row. What is returned below is of the latest look.
  void look(int x);
  // The share of alpha, 0..1, of one instance alone.
  double alpha_of(std::uint32_t instance);
  // The share of alpha, 0..1.
  double alpha() const { return alpha_; }
  const std::vector<VisibleSurface>& surfaces() const { return surfaces_; }
  const std::vector<PixelPlace>& reads() const { return reads_; }
  const RayTriangle& triangle(std::size_t candidate) const { return *candidates_[candidate].of; }
  // True where triangles of more than one instance may touch the pixel.
  bool has_several() const { return has_several_; }
  const PixelRay& ray() const { return ray_; }
  const PixelFunctions& functions(std::size_t candidate) const {
    return candidates_[candidate].functions;
  }

 private:
  // All instances, in place of the index of one.
  static constexpr std::uint32_t kAll = 0xffffffff;
  // A span of RayTriangles over a pixel's exposure.
  struct PixelSpan {
    // The middle and half of the exposure, in u.
    float u = 0, half_u = 0;
    // The part of the exposure that belongs to the span: its ends in u, and as shares.
    float from_u = 0, to_u = 0;
    float from = 0, to = 1;
  };
  // Shares of an axis.
  struct Range {
    float from = 0, to = 1;
  };
  // A triangle that may be visible in the pixel.
  struct Candidate {
    const RayTriangle* of = nullptr;
    // At an instant the places across (x) and down (y) at which it can be; with an exposure both
    // are the times at which it can be over the pixel.
    Range of_samples;
    Range of_lines;
    // True where it covers the whole pixel all the time.
    bool is_everywhere = false;
    PixelFunctions functions;
  };
  void find_spans(int x);
  void begin_pixel(int x);
  void add_candidate(std::uint32_t triangle);
  // False where the triangle is outside of the pixel.
  bool clip_place(const RayTriangle& triangle, Candidate& candidate) const;
  bool clip_time(const RayTriangle& triangle, const PixelSpan& span, Candidate& candidate);

  // Sets alpha and, where `only` is kAll, the surfaces.
  void look_at(std::uint32_t only);
  bool counts(const Candidate& candidate, std::uint32_t only) const {
    return only == kAll || candidate.of->instance == only;
  }
  double opaque_alpha(std::uint32_t only);
  void sample(int n, std::uint32_t only);
  void keep_nearest(std::size_t candidate);
  void add_fragments(std::size_t candidate);
  void resolve_opaque();
  void resolve_fragments();
  // What a sample sees.
  void add(std::size_t candidate, float weight, float light, int sample);
  // `scale`: of the sums over the samples.
  void list_surfaces(double scale);
  float opacity_of(const Candidate& candidate, std::size_t sample) const;

  const RayTriangles& triangles_;
  const std::vector<PlacedInstance>& instances_;
  const PixelRays& rays_;
  const SampleCounts& counts_;
  const PixelLines lines_;
  const bool by_time_;
  // Of the row.
  int y_ = 0;
  int x0_ = 0;
  struct Columns {
    std::uint32_t triangle;
    int from;
    int to;
  };
  std::vector<Columns> columns_;
  std::vector<std::uint32_t> first_;
  std::vector<std::uint32_t> next_;
  std::vector<std::uint32_t> list_;
  // By RayTriangles::spans(), of the row or of the pixel.
  std::vector<PixelSpan> spans_;

  // Of the pixel.
  int x_ = 0;
  PixelRay ray_;
  bool has_several_ = false;
  // The least inverse distance of an opaque triangle that covers the whole pixel, and its instance:
  // what is farther of that is hidden.
  float hidden_ = 0;
  std::uint32_t hidden_instance_ = 0;
  // By how much more the triangles move down than across, in pixels, summed.
  float moves_down_px_ = 0;
  std::vector<Candidate> candidates_;
  CoverageMasks masks_;

  Samples samples_;
  // The visibility buffer: 0 and -1 where nothing is.
  alignas(64) std::array<float, Samples::kMost> inverse_depth_;
  alignas(64) std::array<std::int32_t, Samples::kMost> nearest_;
  // The least inverse distance in each block of samples: what is farther is hidden there.
  std::array<float, Samples::kMost / Samples::kBlock> hidden_of_block_;
  // A-buffer fragments: for each translucent triangle, its inverse distance at each sample, or 0.
  struct FragmentLayer {
    std::size_t candidate;
    std::array<float, Samples::kMost> inverse_depth;
  };
  std::vector<FragmentLayer> layers_;
  std::size_t layer_count_ = 0;
  std::vector<std::pair<float, std::size_t>> fragments_;

  // By candidate.
  struct Sum {
    float weight = 0, light = 0;
    std::uint32_t samples = 0;
    // How many of them are read: one whenever the sum of `reads` over them passes their number.
    std::uint32_t reads = 0;
    std::uint32_t phase = 0;
    std::uint32_t surface = 0;
  };
  std::vector<Sum> sums_;
  // In the order of the samples: what each sees.
  struct VisibleSample {
    std::uint32_t candidate;
    std::uint32_t sample;
  };
  std::vector<VisibleSample> visible_;

  double alpha_ = 0;
  std::vector<VisibleSurface> surfaces_;
  std::vector<PixelPlace> reads_;
};

}  // namespace airtruth::render
