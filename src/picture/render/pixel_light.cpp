// SPDX-License-Identifier: Apache-2.0
#include "picture/render/pixel_light.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

#include "picture/render/packets.h"

namespace airtruth::render {
namespace {

// A spot reads its texture with the width of a square of this share of the pixel at most, though it
// stands for more: a coarser mip level would mix parts of the texture that belong elsewhere.
constexpr float kMostReadShare = 1.0f / 28;

// Up to this number of spots a prefetch costs more than it saves.
constexpr std::size_t kFewReads = 8;

// A spot's point of the surface.
struct Point {
  Eigen::Vector3f in_body;
  float distance_m;
  Surface surface;
  Sunlit sunlit;
  std::optional<Skin> skin;
};

// The spots of one triangle, [begin, end).
struct Range {
  std::size_t begin;
  std::size_t end;
  Around around;
  // At the mean of the places and times of all spots.
  float distance_m;
  // Over the spots that are known: the number of their samples, and the sum over those.
  float samples;
  std::array<float, 3> rgb;
  Spread spread;
};

Eigen::Vector3f place_of(const Placed& placed, const Hit& hit) {
  const Facet& facet = placed.facet(hit);
  return placed.body_from_part[static_cast<std::size_t>(hit.part)] *
         Eigen::Vector3f((1 - hit.u - hit.v) * facet.corner[0] + hit.u * facet.corner[1] +
                         hit.v * facet.corner[2]);
}

Point point_of(const Placed& placed, const PixelEye& eye, const Spot& spot) {
  Point point;
  point.in_body = place_of(placed, spot.hit);
  const Eigen::Vector3f from_eye = (point.in_body.cast<double>() - eye.at(spot.time)).cast<float>();
  point.distance_m = from_eye.norm();
  point.surface = surface_at(placed, from_eye / point.distance_m, spot.hit);
  point.sunlit = sunlit_at(placed, point.surface, placed.material(placed.facet(spot.hit)));
  return point;
}

bool same_triangle(const Spot& a, const Spot& b) {
  return a.hit.triangle == b.hit.triangle && a.hit.part == b.hit.part;
}

Spot mean_of(std::span<const Spot> spots) {
  Spot mean = spots[0];
  if (spots.size() == 1) return mean;
  float u = 0;
  float v = 0;
  float time = 0;
  float samples = 0;
  for (const Spot& spot : spots) {
    u += spot.samples * spot.hit.u;
    v += spot.samples * spot.hit.v;
    time += spot.samples * spot.time;
    samples += spot.samples;
  }
  mean.hit.u = u / samples;
  mean.hit.v = v / samples;
  mean.time = time / samples;
  mean.samples = samples;
  return mean;
}

bool is_known(const Range& range, float share) {
  // Below one code value of a video in the middle of its range.
  constexpr float kTolerance = 0.01f;
  return range.spread.count >= 3 && range.spread.is_known(share, kTolerance);
}

// Computes the light of a pixel's spots.
class Shading {
 public:
  Shading(const Placed& placed,
          const PixelEye& eye,
          std::span<const Spot> spots,
          const Light& light,
          float of_samples,
          float sample_rad)
      : placed_(placed),
        eye_(eye),
        spots_(spots),
        light_(light),
        of_samples_(of_samples),
        sample_rad_(sample_rad) {
    for (std::size_t i = 0; i < spots.size(); ++i) {
      if (i == 0 || !same_triangle(spots[i - 1], spots[i]))
        ranges_[count_++] = {i, i, {}, 0, 0, {}, {}};
      ++ranges_[count_ - 1].end;
      samples_ += spots[i].samples;
    }
  }

  PixelLight all() {
    for (std::size_t r = 0; r < count_; ++r) ask(r, true);
    shade_asked();
    for (std::size_t r = 0; r < count_; ++r)
      if (!is_known(ranges_[r], samples_of(ranges_[r]) / samples_)) ask(r, false);
    shade_asked();
    PixelLight sum;
    for (std::size_t r = 0; r < count_; ++r) {
      const Range& range = ranges_[r];
      const auto share = static_cast<double>(samples_of(range) / samples_);
      const double weight = share / static_cast<double>(range.samples);
      for (std::size_t c = 0; c < 3; ++c) sum.rgb[c] += weight * static_cast<double>(range.rgb[c]);
      sum.distance_m += share * static_cast<double>(range.distance_m);
      sum.spread.add(range.spread);
    }
    return sum;
  }

 private:
  float samples_of(const Range& range) const {
    float sum = 0;
    for (std::size_t i = range.begin; i < range.end; ++i) sum += spots_[i].samples;
    return sum;
  }

  // Asks for the spots of a triangle that lead, or for the others. All of a few lead.
  void ask(std::size_t r, bool leading) {
    constexpr std::size_t kFew = 4;
    Range& range = ranges_[r];
    const bool all_lead = range.end - range.begin <= kFew ||
                          std::none_of(spots_.begin() + static_cast<std::ptrdiff_t>(range.begin),
                                       spots_.begin() + static_cast<std::ptrdiff_t>(range.end),
                                       [](const Spot& spot) { return spot.leads; });
    if (!leading && all_lead) return;
    const bool is_one = range.end - range.begin == 1;
    if (leading && !is_one) look_at_middle(range);
    const Point* last = nullptr;
    float last_samples = 0;
    for (std::size_t i = range.begin; i < range.end; ++i) {
      if ((all_lead || spots_[i].leads) != leading) continue;
      asked_[n_] = {static_cast<std::uint16_t>(i), static_cast<std::uint16_t>(r)};
      Point& point = points_[n_] = point_of(placed_, eye_, spots_[i]);
      if (is_one) {
        range.distance_m = point.distance_m;
        range.around = around_at(placed_, point.surface, spots_[i].hit, light_);
      }
      if (last != nullptr && spots_[i].samples == last_samples)
        point.skin = last->skin;
      else
        point.skin = skin_of(spots_[i], range.distance_m);
      last = &point;
      last_samples = spots_[i].samples;
      if (spots_.size() > kFewReads) point.skin->prefetch(spots_[i].hit.u, spots_[i].hit.v);
      ++n_;
    }
  }

  void look_at_middle(Range& range) const {
    const Spot mean = mean_of(spots_.subspan(range.begin, range.end - range.begin));
    const Eigen::Vector3f from_eye =
        (place_of(placed_, mean.hit).cast<double>() - eye_.at(mean.time)).cast<float>();
    // Over a triangle in a pixel the distance is linear in place and time.
    range.distance_m = from_eye.norm();
    const Surface surface = surface_at(placed_, from_eye / range.distance_m, mean.hit);
    range.around = around_at(placed_, surface, mean.hit, light_);
  }

  Skin skin_of(const Spot& spot, float distance_m) const {
    const float most = std::max(1.0f, kMostReadShare * of_samples_);
    return {placed_.model->mesh,
            placed_.facet(spot.hit),
            distance_m * sample_rad_ * std::sqrt(std::clamp(spot.samples, 1.0f, most))};
  }

  void shade_asked() {
    find_shadows();
    for (std::size_t k = 0; k < n_; ++k) {
      const Spot& spot = spots_[asked_[k].spot];
      const Point& point = points_[k];
      Range& range = ranges_[asked_[k].range];
      const Facet& facet = placed_.facet(spot.hit);
      const Rgb rgb = colour_of(placed_.material(facet),
                                point.skin->albedo(spot.hit.u, spot.hit.v),
                                range.around,
                                point.sunlit,
                                point.surface.cosine,
                                in_shadow_[k] != 0,
                                light_);
      range.spread.add(rgb);
      range.samples += spot.samples;
      for (std::size_t c = 0; c < 3; ++c) range.rgb[c] += spot.samples * rgb[c];
    }
    n_ = 0;
  }

  // Spots that face away from the sun are in shadow without a ray.
  void find_shadows() {
    std::size_t rays = 0;
    for (std::size_t k = 0; k < n_; ++k) {
      in_shadow_[k] = 1;
      if (!(points_[k].sunlit.sun > 0)) continue;
      of_ray_[rays] = static_cast<std::uint16_t>(k);
      to_sun_[rays++] = to_sun_from(placed_, points_[k].in_body, points_[k].surface);
    }
    find_blocked(*placed_.model, {to_sun_.data(), rays}, {blocked_.data(), rays});
    for (std::size_t i = 0; i < rays; ++i) in_shadow_[of_ray_[i]] = blocked_[i];
  }

  struct Scratch {
    std::array<Point, kMostSpots> points;
    std::array<Range, kMostSpots> ranges;
  };
  static Scratch& scratch() {
    thread_local Scratch scratch;
    return scratch;
  }

  const Placed& placed_;
  const PixelEye& eye_;
  std::span<const Spot> spots_;
  const Light& light_;
  // The number of samples over the whole pixel.
  float of_samples_;
  float sample_rad_;
  float samples_ = 0;
  std::size_t count_ = 0;
  // Not cleared for each pixel, nor are the points.
  std::array<Range, kMostSpots>& ranges_ = scratch().ranges;

  // What was asked for and is not shaded yet.
  struct Asked {
    std::uint16_t spot;
    std::uint16_t range;
  };
  std::size_t n_ = 0;
  std::array<Asked, kMostSpots> asked_;
  std::array<Point, kMostSpots>& points_ = scratch().points;
  std::array<BodyRay, kMostSpots> to_sun_;
  std::array<std::uint16_t, kMostSpots> of_ray_;
  std::array<std::uint8_t, kMostSpots> blocked_;
  std::array<std::uint8_t, kMostSpots> in_shadow_;
};

}  // namespace

void Spread::add(const Rgb& rgb) {
  ++count;
  for (std::size_t c = 0; c < 3; ++c) {
    sum[c] += rgb[c];
    squares[c] += rgb[c] * rgb[c];
  }
}

void Spread::add(const Spread& other) {
  count += other.count;
  for (std::size_t c = 0; c < 3; ++c) {
    sum[c] += other.sum[c];
    squares[c] += other.squares[c];
  }
}

bool Spread::is_known(float share, float tolerance) const {
  // Linear light below which the tolerance stays the same.
  constexpr float kNearBlack = 0.03f;
  if (count < 2) return false;
  const auto n = static_cast<float>(count);
  for (std::size_t c = 0; c < 3; ++c) {
    const float mean = sum[c] / n;
    const float variance = (squares[c] - n * mean * mean) / (n - 1);
    const float allowed = tolerance * (mean + kNearBlack);
    if (share * share * variance > n * allowed * allowed) return false;
  }
  return true;
}

PixelEye::PixelEye(const PixelRays& rays, bool moves) : eye_(rays.eye()), moves_(moves) {}

PixelEye::PixelEye(const TracedIntruder& actor, const RayGrid& grid, int x, int y)
    : eye_{actor.eye_in_body, Vector3::Zero(), Vector3::Zero()} {
  if (!actor.moves) return;
  moves_ = true;
  const double middle_s = grid.middle_s(x, y);
  const auto at = [&](double exposures) {
    return between(actor.eye_in_body_at, grid.span().u(middle_s + exposures * grid.exposure_s()));
  };
  const Vector3 first = at(-0.5);
  const Vector3 last = at(0.5);
  eye_[0] = at(0);
  eye_[1] = 0.5 * (last - first);
  eye_[2] = 0.5 * (last - 2 * eye_[0] + first);
}

Vector3 PixelEye::at(float time) const {
  if (!moves_) return eye_[0];
  const double u = 2.0 * time - 1;
  return eye_[0] + u * (eye_[1] + u * eye_[2]);
}

PixelLight light_of(const Placed& placed,
                    const PixelEye& eye,
                    const Visible& visible,
                    const Light& light,
                    double pixel_rad) {
  const auto samples = static_cast<float>(visible.of_samples);
  const float sample_rad = static_cast<float>(pixel_rad) / std::sqrt(samples);
  return Shading(placed, eye, visible.spots, light, samples, sample_rad).all();
}

}  // namespace airtruth::render
