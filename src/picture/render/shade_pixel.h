// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "picture/render/visibility.h"
#include "picture/shade/texture.h"

namespace airtruth::render {

// The light of a pixel that was looked at: linear and premultiplied, and the sum of the surfaces'
// distances, each weighted by what it contributes to alpha.
struct PixelLight {
  std::array<double, 3> rgb{};
  double distance_m = 0;
};

// A pixel of a layer: shares of 1.
struct RenderedPixel {
  PixelLight light;
  double alpha = 0;
  // By instance: after occlusion by others, and alone.
  std::vector<double> coverage;
  std::vector<double> alone;
};

// Computes the light of pixels. The light of the surroundings is computed once for each surface
// that is visible in a pixel, at the middle of the samples that see it. What changes more within a
// pixel - the sun's light, its shadow and its glint, the texture and the mirrored share - is
// computed at some of those samples and averaged: at a few of the surface's reads, and at more of
// them where the standard error of the mean is not small. The texture is read with the width of the
// read's share of the pixel.
class PixelShading {
 public:
  PixelShading(const std::vector<PlacedInstance>& instances,
               const PixelRays& rays,
               const shade::Light& light)
      : instances_(instances), rays_(rays), light_(light) {}

  PixelLight light_of(const Visibility& visibility, int x, int y);

 private:
  // A place of a visible surface.
  struct Point {
    const shade::Placed* placed;
    shade::Hit hit;
    Eigen::Vector3f in_body;
    float distance_m;
    shade::Surface surface;
    // Of find_sunlight().
    shade::Sunlit sunlit;
    bool in_shadow = true;
    // In shaded_.
    std::uint32_t of = 0;
  };
  // A visible surface, with the colours of its points.
  struct Shaded {
    const VisibleSurface* visible;
    // At the middle of what is visible.
    float distance_m;
    shade::Around around;
    shade::TriangleTexture texture;
    float count = 0;
    Eigen::Array3f sum = Eigen::Array3f::Zero();
  };
  // The colours of a pixel's points.
  struct Colours {
    float count = 0;
    Eigen::Array3f sum = Eigen::Array3f::Zero();
    Eigen::Array3f squares = Eigen::Array3f::Zero();

    void add(const Eigen::Array3f& colour);
    // True where the standard error of their mean is small beside it.
    bool mean_is_known() const;
  };
  Point point_at(const Visibility& visibility,
                 const VisibleSurface& visible,
                 const PixelPlace& at) const;
  Shaded shaded(const Visibility& visibility, const VisibleSurface& visible) const;
  // Adds every `stride`th of the reads, and the middle one of each surface, less those that are
  // shaded already.
  void add_points(const Visibility& visibility, std::uint32_t stride);
  // Adds the colours of the points to their surfaces.
  void shade_points();
  // Sets what the sun does at each of the points.
  void find_sunlight();

  const std::vector<PlacedInstance>& instances_;
  const PixelRays& rays_;
  const shade::Light& light_;
  // Of the pixel: the exposure's middle and half of it, in u of the patch's span.
  double u_ = 0;
  double half_u_ = 0;
  std::vector<Shaded> shaded_;
  // By Visibility::reads().
  std::vector<std::uint8_t> is_shaded_;
  Colours colours_;
  std::vector<Point> points_;
  std::vector<shade::BodyRay> to_sun_;
  std::vector<std::uint32_t> of_ray_;
  std::vector<std::uint8_t> blocked_;
};

}  // namespace airtruth::render
