// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "picture/render/pixel_rays.h"

// The light of a pixel that one opaque aircraft covers, from some of its samples.
//
// Visibility, the sun's light and shadow and the texture are found at every sample. The light of
// the surroundings is computed once for all samples of a triangle, at the mean of their places:
// within a pixel it is smooth over a triangle.
namespace airtruth::render {

class PixelLight {
 public:
  // Largest number of samples of one call of add().
  static constexpr std::size_t kMostAtOnce = 64;

  // rays: of the pixel; start_m: their start before the aircraft. footprint_per_m: the width on the
  // surface that a sample represents, as a share of its distance. The object keeps references.
  PixelLight(const Placed& placed,
             const PixelRays& rays,
             const Light& light,
             double start_m,
             float footprint_per_m);

  // Adds samples that the aircraft covers. One that meets no surface is left out: so close to an
  // edge the float and the double computation disagree.
  void add(std::span<const int> samples);

  // Number of the samples that met a surface.
  int count() const { return count_; }
  const std::array<double, 3>& rgb_sum() const { return rgb_sum_; }
  double distance_sum_m() const { return distance_sum_m_; }
  // True where the standard error of the mean colour, times `share`, is small beside the colour.
  bool is_known(double share) const;

 private:
  // The samples of one triangle.
  struct Facet {
    Hit mean;
    Eigen::Vector3f view;
    int samples = 0;
  };
  void add(const Rgb& rgb);
  void trace(std::span<const int> samples);
  void sort_by_triangle();
  void find_shadows();

  const Placed& placed_;
  const PixelRays& rays_of_;
  const Light& light_;
  double start_m_;
  float footprint_per_m_;
  int count_ = 0;
  std::array<double, 3> rgb_sum_{};
  double distance_sum_m_ = 0;
  std::array<double, 3> square_sum_{};

  // Of the samples of one call of add() that meet a surface.
  std::size_t n_ = 0;
  std::array<BodyRay, kMostAtOnce> rays_;
  std::array<double, kMostAtOnce> dt_s_;
  std::array<std::optional<Hit>, kMostAtOnce> hits_;
  std::array<std::size_t, kMostAtOnce> facet_of_;
  std::array<Sunlit, kMostAtOnce> sunlit_;
  std::array<std::uint8_t, kMostAtOnce> in_shadow_;
  std::size_t facet_count_ = 0;
  std::array<Facet, kMostAtOnce> facets_;
};

}  // namespace airtruth::render
