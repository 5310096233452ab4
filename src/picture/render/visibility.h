// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "picture/render/pixel_rays.h"
#include "picture/render/ray_triangles.h"
#include "picture/render/samples.h"

// What a pixel's samples see. The triangles over the pixel, nearest first, are tested against the
// samples by their edge functions (Pineda 1988, "A parallel algorithm for polygon rasterization");
// a visibility buffer keeps the nearest opaque one of each sample with its inverse distance
// (Catmull 1974). Translucent triangles before it are kept as fragments of the sample and blended
// in the order of their distance (the A-buffer: Carpenter 1984).
//
// Over a pixel and its exposure the edge functions are of the form
//
//   (at + per_t t + per_tt t^2) + x (per_x + per_xt t) + y (per_y + per_yt t)
//
// in the units of Samples. The terms that no sample can tell are left out.
namespace airtruth::render {

// The four functions of a RayTriangle over a pixel.
struct PixelFunctions {
  Eigen::Array4f at, per_x, per_y, per_t, per_xt, per_yt, per_tt;

  Eigen::Array4f operator()(float x, float y, float t) const {
    return (at + per_t * t + per_tt * (t * t)) + x * (per_x + per_xt * t) +
           y * (per_y + per_yt * t);
  }
};
// `u`: the middle of the pixel's exposure in the triangle's span; `half_u`: half of the exposure.
PixelFunctions functions_over(const RayTriangle& triangle,
                              const PixelRay& ray,
                              float u,
                              float half_u);

// A place and a time in a pixel, as in Samples.
struct PixelPlace {
  float x = 0, y = 0, t = 0;
};

// A triangle that is visible in a pixel.
struct VisibleSurface {
  std::uint32_t triangle = 0;  // of RayTriangles::all()
  // In the pixel's list of triangles.
  std::uint32_t in_pixel = 0;
  // Over the samples: what the surface contributes to alpha, and the share of light that nearer
  // surfaces let through to it.
  float weight = 0;
  float light = 0;
  // The mean of the samples that see it and are read.
  PixelPlace middle;
  // Of VisiblePixel::reads: [first_read, end_read) are spread evenly over what is visible.
  std::uint32_t first_read = 0;
  std::uint32_t end_read = 0;  // at least one
};

// The result for a pixel.
struct VisiblePixel {
  int samples = 0;
  double alpha = 0;  // over the samples, 0..samples
  std::vector<VisibleSurface> surfaces;
  std::vector<PixelPlace> reads;
};

class Visibility {
 public:
  Visibility(const RayTriangles& triangles,
             const std::vector<PlacedInstance>& instances,
             const PixelRays& rays)
      : triangles_(triangles), instances_(instances), rays_(rays) {}

  // Sorts the triangles of a row of the patch into its pixels.
  void begin_row(int y, int x0, int x1);
  std::span<const std::uint32_t> triangles_of(int x) const {
    const auto pixel = static_cast<std::size_t>(x - x0_);
    return {list_.data() + first_[pixel], list_.data() + first_[pixel + 1]};
  }

  // Looks at a pixel of the row by n samples. `only`: the only instance that counts, or kAll. The
  // surfaces are known until the next look.
  static constexpr std::uint32_t kAll = 0xffffffff;
  void look(int x, int n, std::uint32_t only = kAll);
  // The share of alpha, 0..1.
  double alpha() const { return result_.alpha / result_.samples; }
  // True where no sample sees a surface, and where all see opaque ones of one instance.
  bool is_empty() const { return result_.alpha == 0; }
  bool is_full() const { return is_full_; }
  std::uint32_t full_of() const { return full_of_; }
  const VisiblePixel& result() const { return result_; }
  std::uint32_t instance_of(const VisibleSurface& surface) const {
    return triangles_.all()[surface.triangle].instance;
  }
  // True where triangles of more than one instance may touch a pixel.
  bool has_several(int x) const;
  // The ray of the pixel that was looked at, and the functions of one of its triangles.
  const PixelRay& ray() const { return ray_; }
  const PixelFunctions& functions(std::size_t in_pixel) const { return functions_[in_pixel]; }

 private:
  // A span of RayTriangles over a pixel's exposure.
  struct PixelSpan {
    // The middle, half and ends of the exposure, in u.
    float u = 0, half_u = 0, from_u = 0, to_u = 0;
    // The part of the samples that belongs to the span, as shares of all strata.
    float from = 0, to = 1;
  };
  // A triangle over the pixel, once it is known.
  struct Candidate {
    bool known = false;
    bool is_outside = true;
    bool is_uniform = false;
    // The part of the samples that can see it, as shares of all strata.
    float from = 0, to = 1;
  };
  void find_spans(int x);
  // Empty where the triangle is outside the pixel.
  const Candidate& candidate(std::size_t in_pixel, const RayTriangle& triangle);
  void clip_place(const RayTriangle& triangle, Candidate& candidate) const;
  void clip_time(const RayTriangle& triangle, const PixelSpan& span, Candidate& candidate) const;
  void begin_pixel(int x);
  void keep_nearest(std::size_t in_pixel, const RayTriangle& triangle, const Candidate& candidate);
  void add_fragments(std::size_t in_pixel, const RayTriangle& triangle, const Candidate& candidate);
  void resolve(std::span<const std::uint32_t> list);
  void resolve_opaque();
  void resolve_fragments(std::span<const std::uint32_t> list);
  void add(std::size_t in_pixel, float weight, float light, std::size_t sample);
  void finish(std::span<const std::uint32_t> list);
  float opacity_of(const RayTriangle& triangle, std::size_t in_pixel, std::size_t sample) const;

  const RayTriangles& triangles_;
  const std::vector<PlacedInstance>& instances_;
  const PixelRays& rays_;
  // Of the row.
  int y_ = 0;
  int x0_ = 0;
  std::vector<std::uint32_t> first_;
  std::vector<std::uint32_t> list_;

  // By RayTriangles::spans(), of the row or of the pixel.
  std::vector<PixelSpan> spans_;

  // Of the pixel.
  int x_ = kNoPixel;
  static constexpr int kNoPixel = -1;
  bool by_time_ = false;
  PixelRay ray_;
  Samples samples_;
  std::vector<Candidate> candidates_;
  std::vector<PixelFunctions> functions_;
  // The visibility buffer: 0 and -1 where nothing is.
  alignas(64) std::array<float, Samples::kMost> inverse_depth_;
  alignas(64) std::array<std::int32_t, Samples::kMost> nearest_;
  // The least inverse distance in each stratum: what is farther is hidden there.
  std::array<float, Samples::kMostStrata> hidden_;
  // A-buffer fragments: for each translucent triangle, its inverse distance at each sample, or 0.
  struct FragmentLayer {
    std::size_t in_pixel;
    std::array<float, Samples::kMost> inverse_depth;
  };
  std::vector<FragmentLayer> layers_;
  std::size_t layer_count_ = 0;

  // By the index in the pixel's list: what a triangle contributes, how many samples see it, and one
  // of those.
  struct Sum {
    double weight = 0, light = 0;
    int samples = 0;
    std::uint32_t one = 0;
  };
  std::vector<Sum> sums_;
  // The samples that are read, with the index of their triangle.
  struct Read {
    std::uint32_t in_pixel;
    std::uint32_t sample;
  };
  std::vector<Read> read_;
  VisiblePixel result_;
  bool is_full_ = false;
  std::uint32_t full_of_ = 0;
};

}  // namespace airtruth::render
