// SPDX-License-Identifier: Apache-2.0
#include "picture/render/pixel_light.h"

#include <algorithm>
#include <cmath>

#include "picture/render/packets.h"

namespace airtruth::render {

PixelLight::PixelLight(const Placed& placed,
                       const PixelRays& rays,
                       const Light& light,
                       double start_m,
                       float footprint_per_m)
    : placed_(placed),
      rays_of_(rays),
      light_(light),
      start_m_(start_m),
      footprint_per_m_(footprint_per_m) {}

void PixelLight::add(std::span<const int> samples) {
  trace(samples);
  sort_by_triangle();
  find_shadows();
  for (std::size_t f = 0; f < facet_count_; ++f) {
    const Facet& facet = facets_[f];
    const auto distance_m = static_cast<float>(start_m_ + facet.mean.t);
    const Skin skin(placed_, facet.mean, footprint_per_m_ * distance_m);
    const Around around = around_at(placed_, facet.view, facet.mean, light_);
    for (std::size_t i = 0; i < n_; ++i) {
      if (facet_of_[i] != f) continue;
      const Texel texel = skin.albedo(hits_[i]->u, hits_[i]->v);
      add(colour_of(skin.material(), texel, around, sunlit_[i], in_shadow_[i] != 0, light_));
      distance_sum_m_ += start_m_ + hits_[i]->t;
    }
  }
  count_ += static_cast<int>(n_);
}

void PixelLight::add(const Rgb& rgb) {
  for (std::size_t c = 0; c < 3; ++c) {
    const double value = rgb[c];
    rgb_sum_[c] += value;
    square_sum_[c] += value * value;
  }
}

void PixelLight::trace(std::span<const int> samples) {
  const std::size_t asked = samples.size();
  for (std::size_t i = 0; i < asked; ++i) rays_[i] = rays_of_.ray(samples[i], dt_s_[i]);
  nearest_hits(placed_,
               std::span(rays_).first(asked),
               std::span(dt_s_).first(asked),
               std::span(hits_).first(asked));
  n_ = 0;
  for (std::size_t i = 0; i < asked; ++i) {
    if (!hits_[i]) continue;
    hits_[n_] = hits_[i];
    rays_[n_++] = rays_[i];
  }
}

void PixelLight::sort_by_triangle() {
  facet_count_ = 0;
  for (std::size_t i = 0; i < n_; ++i) {
    const Hit& hit = *hits_[i];
    std::size_t f = 0;
    while (f < facet_count_ &&
           (facets_[f].mean.triangle != hit.triangle || facets_[f].mean.part != hit.part))
      ++f;
    facet_of_[i] = f;
    Facet& facet = facets_[f];
    if (f == facet_count_) {
      ++facet_count_;
      facet.mean = {0, hit.part, hit.triangle, 0, 0};
      facet.view = rays_[i].direction;
      facet.samples = 0;
    }
    facet.mean.t += hit.t;
    facet.mean.u += hit.u;
    facet.mean.v += hit.v;
    ++facet.samples;
  }
  for (std::size_t f = 0; f < facet_count_; ++f) {
    const float share = 1 / static_cast<float>(facets_[f].samples);
    facets_[f].mean.t *= share;
    facets_[f].mean.u *= share;
    facets_[f].mean.v *= share;
  }
}

void PixelLight::find_shadows() {
  std::array<BodyRay, kMostAtOnce> to_sun;
  std::array<std::size_t, kMostAtOnce> sample_of;
  std::array<std::uint8_t, kMostAtOnce> blocked;
  std::size_t lit = 0;
  for (std::size_t i = 0; i < n_; ++i) {
    in_shadow_[i] = 1;
    sunlit_[i] = sunlit_at(placed_, rays_[i].direction, *hits_[i], light_);
    if (!(sunlit_[i].sun > 0)) continue;
    sample_of[lit] = i;
    to_sun[lit++] = to_sun_from(placed_, rays_[i], *hits_[i], sunlit_[i]);
  }
  find_blocked(*placed_.model, std::span(to_sun).first(lit), std::span(blocked).first(lit));
  for (std::size_t k = 0; k < lit; ++k) in_shadow_[sample_of[k]] = blocked[k];
}

bool PixelLight::is_known(double share) const {
  // A share of the colour: about one code value of a video in the middle of its range.
  constexpr double kTolerance = 0.015;
  // Linear light below which the tolerance stays the same.
  constexpr double kNearBlack = 0.03;
  if (count_ < 2) return false;
  const double n = count_;
  for (std::size_t c = 0; c < 3; ++c) {
    const double mean = rgb_sum_[c] / n;
    const double variance = (square_sum_[c] - n * mean * mean) / (n - 1);
    const double allowed = kTolerance * (mean + kNearBlack);
    if (share * share * variance > n * allowed * allowed) return false;
  }
  return true;
}

}  // namespace airtruth::render
