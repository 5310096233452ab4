// SPDX-License-Identifier: Apache-2.0
#include "picture/composite/spots.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "foundation/base/error.h"

namespace airtruth::composite {
namespace {

// Samples along each side of a pixel. The fade over w pixels bends by 6 / w^2 at most, and the mean
// of n x n samples is off by that over 24 n^2: by 0.004 at most where w is 4 or more. A sharp rim,
// which nothing on a lens has, is right within 1/8.
int samples_a_side(const image::Spot& spot) {
  const double fade_px = spot.softness * spot.radius_px;
  return fade_px >= 16 ? 1 : fade_px >= 4 ? 2 : 4;
}
// Samples in the exposure where the spot moves.
constexpr int kTimes = 16;
// Samples along each side of a spot's bounds for its area.
constexpr int kAreaSide = 96;
// Movement within the exposure below which a single moment is enough.
constexpr double kStillPx = 0.05;

double smooth_step(double x) {
  const double u = std::clamp(x, 0.0, 1.0);
  return u * u * (3 - 2 * u);
}

// The largest share that the lobes can make of the radius.
double widest(const image::Spot& spot) {
  double share = 1;
  for (std::size_t k = 0; k < image::Spot::kLobes; ++k)
    share += std::hypot(spot.cosines[k], spot.sines[k]);
  return share;
}

Pixel across(const Pixel& direction) { return {-direction.y(), direction.x()}; }

// From the spot's centre to the bounds of its wings.
Pixel wings_reach(const image::Spot& spot) {
  return spot.wing_px * across(spot.direction).cwiseAbs() +
         Pixel::Constant(spot.wing_px > 0 ? spot.wing_radius_px : 0);
}

// The alpha of the wings' blur at a place from the spot's centre.
double wings_alpha(const image::Spot& spot, const Pixel& off) {
  if (!(spot.wing_px > 0)) return 0;
  const Pixel along = across(spot.direction);
  const double place = std::clamp(off.dot(along), -spot.wing_px, spot.wing_px);
  const double distance = (off - place * along).norm() / spot.wing_radius_px;
  return distance < 1 ? spot.opacity * spot.wing_share * (1 - smooth_step(distance)) : 0;
}

// The alpha of the capsule or circle alone.
double body_alpha(const image::Spot& spot, const Pixel& off) {
  const double along =
      std::clamp(off.dot(spot.direction), -spot.half_length_px, spot.half_length_px);
  const double distance = (off - along * spot.direction).norm();
  double radius = spot.radius_px;
  if (spot.half_length_px == 0 && distance > 0)
    radius *= spot.lobe(off.x() / distance, off.y() / distance);
  if (!(distance < radius)) return 0;
  if (!(spot.softness > 0)) return spot.opacity;
  return spot.opacity *
         (1 - smooth_step((distance / radius - (1 - spot.softness)) / spot.softness));
}

// Bounds of all that the spot can touch while it moves for `reach_s` before and after its time.
Box bounds_of(const image::Spot& spot, double reach_s) {
  const double round = spot.radius_px * widest(spot);
  const Pixel body = Pixel::Constant(round) + spot.half_length_px * spot.direction.cwiseAbs();
  const Pixel half = body.cwiseMax(wings_reach(spot)) + reach_s * spot.velocity_px_s.cwiseAbs();
  const Pixel low = spot.centre - half;
  return {low.x(), low.y(), 2 * half.x(), 2 * half.y()};
}

double reach_s(const Shutter& shutter) { return 0.5 * (shutter.exposure_s + shutter.readout_s); }

std::optional<PixelBox> pixels_in_frame(const image::Spot& spot, const Spots& all) {
  return intersection(pixels_of(bounds_of(spot, reach_s(all.shutter))),
                      {0, 0, all.frame_width, all.frame_height});
}

// Areas of the spot's alpha, which nothing hides.
image::Areas areas_of(const image::Spot& spot, const Spots& in) {
  const Box box = bounds_of(spot, 0);
  double alone = 0, in_frame = 0;
  for (int j = 0; j < kAreaSide; ++j)
    for (int i = 0; i < kAreaSide; ++i) {
      const Pixel at(box.x + (i + 0.5) * box.width / kAreaSide,
                     box.y + (j + 0.5) * box.height / kAreaSide);
      const double alpha = spot_alpha(spot, at, 0);
      alone += alpha;
      const Pixel seen =
          in.shutter.seen_at(at, spot.velocity_px_s, in.frame_width, in.frame_height);
      if (seen.x() >= 0 && seen.y() >= 0 && seen.x() < in.frame_width && seen.y() < in.frame_height)
        in_frame += alpha;
    }
  const double cell = box.width * box.height / (kAreaSide * kAreaSide);
  in_frame *= cell;
  return {alone * cell, in_frame, in_frame, in_frame, in_frame};
}

void take_out_closed(image::Layer& layer) {
  for (std::size_t i = 0; i < layer.pixels.size(); ++i) {
    if (layer.is_open(i)) continue;
    layer.pixels[i] = {};
    layer.depth_m[i] = std::numeric_limits<float>::infinity();
  }
  for (image::Coverage& coverage : layer.coverage)
    each_pixel(coverage, [&](int x, int y, float& share) {
      if (!layer.is_open(layer.index(x, y))) share = 0;
    });
}

// The layer on a larger patch.
image::Layer on_patch(const image::Layer& layer, const PixelBox& patch, std::size_t intruders) {
  image::Layer result(patch);
  result.coverage = layer.coverage;
  result.coverage.resize(intruders);
  result.areas = layer.areas;
  result.areas.resize(intruders);
  if (layer.empty()) return result;
  for (int y = layer.patch.y; y < layer.patch.bottom(); ++y)
    for (int x = layer.patch.x; x < layer.patch.right(); ++x) {
      const std::size_t from = layer.index(x, y);
      const std::size_t to = result.index(x, y);
      result.pixels[to] = layer.pixels[from];
      result.depth_m[to] = layer.depth_m[from];
    }
  return result;
}

PixelBox patch_with(const image::Layer& layer,
                    const Spots& all,
                    const std::vector<image::Coverage>& covers,
                    int margin_px) {
  std::optional<PixelBox> patch;
  if (!layer.empty()) patch = layer.patch;
  for (const image::Coverage& cover : covers) {
    if (cover.alpha.empty()) continue;
    const PixelBox box =
        *intersection(wider(cover.box, margin_px), {0, 0, all.frame_width, all.frame_height});
    patch = patch ? bounds(*patch, box) : box;
  }
  check(patch.has_value(), "a spot is in view");
  return *patch;
}

// Puts a spot over the layer, as its last intruder.
void put_over(image::Layer& layer, const image::Spot& spot, const image::Coverage& cover) {
  each_pixel(cover, [&](int x, int y, float own) {
    if (!(own > 0)) return;
    const std::size_t i = layer.index(x, y);
    image::LayerPixel& under = layer.pixels[i];
    const float under_alpha = under.alpha;
    under = {own * spot.colour[0] + (1 - own) * under.red,
             own * spot.colour[1] + (1 - own) * under.green,
             own * spot.colour[2] + (1 - own) * under.blue,
             own + (1 - own) * under.alpha};
    // The spot itself is at the distance 0.
    layer.depth_m[i] =
        under_alpha > 0 ? (1 - own) * under_alpha * layer.depth_m[i] / under.alpha : 0;
    for (image::Coverage& coverage : layer.coverage)
      if (coverage.box.contains(x, y)) coverage.alpha[coverage.index(x, y)] *= 1 - own;
  });
  layer.coverage.push_back(cover);
}

// Takes what later spots hide of a spot from its areas: `left` of what it covers by itself.
void hide_share(image::Areas& areas, const image::Coverage& alone, const image::Coverage& left) {
  const auto sum = [](const image::Coverage& of) {
    return std::accumulate(of.alpha.begin(), of.alpha.end(), 0.0);
  };
  if (!(sum(alone) > 0)) return;
  const double share = sum(left) / sum(alone);
  for (double* area : {&areas.seen_px, &areas.free_px, &areas.clear_px}) *area *= share;
}

}  // namespace

double spot_alpha(const image::Spot& spot, const Pixel& at, double dt_s) {
  const Pixel off = at - (spot.centre + dt_s * spot.velocity_px_s);
  const double body = body_alpha(spot, off);
  return spot.wing_px > 0 ? 1 - (1 - body) * (1 - wings_alpha(spot, off)) : body;
}

double pixel_alpha(const image::Spot& spot, int x, int y, const Spots& in) {
  const Shutter& shutter = in.shutter;
  const double moved_px = shutter.exposure_s * spot.velocity_px_s.norm();
  const int times = moved_px > kStillPx ? kTimes : 1;
  const double middle_s =
      shutter.is_instant()
          ? 0
          : shutter.middle_s(Pixel(x + 0.5, y + 0.5), in.frame_width, in.frame_height);
  const int side = samples_a_side(spot);
  double sum = 0;
  for (int j = 0; j < side; ++j)
    for (int i = 0; i < side; ++i) {
      const Pixel at(x + (i + 0.5) / side, y + (j + 0.5) / side);
      for (int k = 0; k < times; ++k)
        sum += spot_alpha(spot, at, middle_s + shutter.exposure_s * ((k + 0.5) / times - 0.5));
    }
  return sum / (side * side * times);
}

std::vector<image::Coverage> covers_of(const Spots& all) {
  std::vector<image::Coverage> covers;
  for (const auto& spot : all.spots) {
    image::Coverage& cover = covers.emplace_back();
    const auto box = spot ? pixels_in_frame(*spot, all) : std::nullopt;
    if (!box) continue;
    cover = image::Coverage(*box);
    each_pixel(cover, [&](int x, int y, float& alpha) {
      alpha = static_cast<float>(pixel_alpha(*spot, x, y, all));
    });
  }
  return covers;
}

bool are_out_of_view(const std::vector<image::Coverage>& covers) {
  return std::all_of(covers.begin(), covers.end(), [](const image::Coverage& cover) {
    return cover.alpha.empty();
  });
}

void hide_behind(image::Layer& layer,
                 const std::vector<image::Coverage>& covers,
                 const Occlusion& occlusion) {
  if (layer.empty()) return;
  Shares shares(occlusion, layer.patch);
  std::vector<float> clear(layer.pixels.size(), 1.0F);
  for (const image::Coverage& cover : covers)
    each_pixel(cover, [&](int x, int y, float alpha) {
      if (layer.patch.contains(x, y)) clear[layer.index(x, y)] *= 1 - alpha;
    });
  for (std::size_t a = 0; a < layer.coverage.size(); ++a) {
    if (layer.coverage[a].empty()) continue;
    const auto& free = shares.past_own_aircraft();
    const auto& past_all = shares.past_all(a);
    each_pixel(layer.coverage[a], [&](int x, int y, double share) {
      const std::size_t i = layer.index(x, y);
      const double hidden = share * (1 - double(clear[i]));
      layer.areas[a].seen_px -= hidden;
      layer.areas[a].free_px -= share_of(free, i) * hidden;
      layer.areas[a].clear_px -= share_of(past_all, i) * hidden;
    });
  }
}

image::Layer with_spots(image::Layer layer,
                        std::size_t intruders,
                        const Spots& all,
                        const std::vector<image::Coverage>& covers,
                        int margin_px) {
  take_out_closed(layer);
  image::Layer result = on_patch(layer, patch_with(layer, all, covers, margin_px), intruders);
  for (std::size_t k = 0; k < all.spots.size(); ++k) {
    const auto& spot = all.spots[k];
    result.areas.push_back(spot ? areas_of(*spot, all) : image::Areas{});
    if (spot)
      put_over(result, *spot, covers[k]);
    else
      result.coverage.emplace_back();
  }
  for (std::size_t k = 0; k < all.spots.size(); ++k)
    hide_share(result.areas[intruders + k], covers[k], result.coverage[intruders + k]);
  return result;
}

}  // namespace airtruth::composite
