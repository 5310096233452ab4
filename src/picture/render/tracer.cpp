// SPDX-License-Identifier: Apache-2.0
#include "picture/render/tracer.h"

#include <algorithm>
#include <cmath>

#include "picture/render/packets.h"

namespace airtruth::render {
namespace {

// Step beyond a translucent surface, in metres.
constexpr float kStep = 1e-4f;
// Footprint of one of the many samples of opacity, as a share of the pixel's side.
constexpr double kSampleShare = 0.25;
// Largest number of translucent surfaces along one ray.
constexpr int kMaxLayers = 24;

Vector3 interpolated(const std::array<Vector3, 4>& corners, const std::array<double, 2>& at) {
  const auto [x, y] = at;
  return ((1 - y) * ((1 - x) * corners[0] + x * corners[1]) +
          y * ((1 - x) * corners[2] + x * corners[3]))
      .normalized();
}

BodyRay body_ray(const TracedIntruder& actor, const Shot& shot) {
  const Vector3 eye = actor.moves ? between(actor.eye_in_body_at, shot.u) : actor.eye_in_body;
  const Vector3 d =
      actor.moves
          ? Vector3((between(actor.body_from_world_at, shot.u) * shot.direction).normalized())
          : Vector3(actor.body_from_world * shot.direction);
  return {(eye + actor.start_m * d).cast<float>(), d.cast<float>().normalized()};
}

}  // namespace

TracedIntruder place(const Instance& instance,
                     const View& view,
                     const Light& light,
                     const std::optional<Box>& search,
                     const Span& span) {
  TracedIntruder actor;
  const Model::Impl& model = instance.model->impl();
  actor.placed.model = &model;
  actor.moves = !span.is_instant();
  for (std::size_t k = 0; k < 3; ++k) {
    const double dt_s = span.at(static_cast<int>(k));
    const Rigid body_from_world = carried(instance.world_from_body, instance.twist, dt_s).inverse();
    actor.body_from_world_at[k] = body_from_world.rotation.toRotationMatrix();
    actor.eye_in_body_at[k] = body_from_world * view.at(dt_s).world_from_cam.translation;
  }
  actor.body_from_world = actor.body_from_world_at[1];
  actor.eye_in_body = actor.eye_in_body_at[1];
  double nearest_m = INFINITY;
  for (const Vector3& eye : actor.eye_in_body_at)
    nearest_m = std::min(nearest_m, (eye - model.centre_in_body).norm());
  actor.start_m = std::max(0.0, nearest_m - model.radius_m);
  actor.placed.to_sun_in_body =
      (actor.body_from_world * light.to_sun_in_world).normalized().cast<float>();
  actor.placed.up_in_body = (actor.body_from_world * Vector3(0, 0, -1)).cast<float>();
  if (light.surroundings)
    actor.placed.surroundings =
        light.surroundings->turned(actor.body_from_world.transpose().cast<float>());
  actor.placed.time_s = instance.time_s;
  const double turned_at_s = instance.time_s + (actor.moves ? 0 : span.begin_s);
  for (const aircraft::Part& part : model.mesh.parts) {
    actor.placed.body_from_part.push_back(aircraft::body_from_part(part, turned_at_s));
    actor.placed.part_from_body.push_back(actor.placed.body_from_part.back().inverse());
    actor.placed.swings.push_back(SwingTable::of(part, instance.time_s, span));
  }
  actor.pixels = pixels_to_search(search, view);
  return actor;
}

std::optional<PixelBox> pixels_to_search(const std::optional<Box>& search, const View& view) {
  if (!search) return std::nullopt;
  return intersection(pixels_of(*search), {0, 0, view.width, view.height});
}

PixelShots::PixelShots(const RayGrid& grid, int x, int y)
    : samples_(x, y), is_instant_(grid.span().is_instant()), span_(grid.span()) {
  if (!is_instant_) {
    middle_s_ = grid.middle_s(x, y);
    exposure_s_ = grid.exposure_s();
  }
  for (int k = is_instant_ ? 1 : 0; k < (is_instant_ ? 2 : 3); ++k) {
    corners_[static_cast<std::size_t>(k)] = grid.corners(x, y, k);
    known_ = known_ && finite(corners_[static_cast<std::size_t>(k)]);
  }
  pixel_rad_ = (corners_[1][1] - corners_[1][0]).norm();
}

Shot PixelShots::operator()(int sample) const {
  const auto at = samples_.at(sample);
  if (is_instant_) return {interpolated(corners_[1], at), 0, 0};
  const double dt_s = middle_s_ + exposure_s_ * (samples_.time(sample) - 0.5);
  const double u = span_.u(dt_s);
  const Thrice<Vector3> directions = {
      interpolated(corners_[0], at), interpolated(corners_[1], at), interpolated(corners_[2], at)};
  return {between(directions, u).normalized(), u, dt_s};
}

bool finite(const std::array<Vector3, 4>& corners) {
  return std::all_of(
      corners.begin(), corners.end(), [](const Vector3& corner) { return corner.allFinite(); });
}

void Tracer::sample(
    int x, int y, int from, int to, Sum& sum, double* coverage, double* alone) const {
  const PixelShots shot_of(grid_, x, y);
  sum.count += to - from;
  if (!shot_of.known()) return;
  const double pixel_rad = shot_of.pixel_rad();
  std::array<Shot, kTogether> shots;
  std::array<std::vector<Fragment>, kTogether> fragments;
  for (int first = from; first < to; first += static_cast<int>(kTogether)) {
    const std::size_t n = std::min(kTogether, static_cast<std::size_t>(to - first));
    for (std::size_t i = 0; i < n; ++i) {
      shots[i] = shot_of(first + static_cast<int>(i));
      fragments[i].clear();
    }
    const auto now = std::span(shots).first(n);
    for (std::size_t a = 0; a < actors_.size(); ++a) {
      if (!actors_[a].pixels || !actors_[a].pixels->contains(x, y)) continue;
      alone[a] += collect(static_cast<int>(a), now, pixel_rad, std::span(fragments).first(n));
    }
    for (std::size_t i = 0; i < n; ++i)
      if (!fragments[i].empty()) add(shots[i], pixel_rad, fragments[i], sum, coverage);
  }
}

double Tracer::collect(int actor_index,
                       std::span<const Shot> shots,
                       double pixel_rad,
                       std::span<std::vector<Fragment>> fragments) const {
  const TracedIntruder& actor = actors_[static_cast<std::size_t>(actor_index)];
  // The rays that go on, with their samples.
  std::array<BodyRay, kTogether> rays;
  std::array<double, kTogether> dt_s;
  std::array<float, kTogether> from_m{};
  std::array<std::size_t, kTogether> sample;
  std::array<double, kTogether> through;
  std::size_t count = shots.size();
  for (std::size_t i = 0; i < count; ++i) {
    rays[i] = body_ray(actor, shots[i]);
    dt_s[i] = shots[i].dt_s;
    sample[i] = i;
    through[i] = 1;
  }
  std::array<std::optional<Hit>, kTogether> hits;
  for (int layer = 0; layer < kMaxLayers && count > 0; ++layer) {
    nearest_hits(actor.placed,
                 std::span(rays).first(count),
                 std::span(dt_s).first(count),
                 std::span(from_m).first(count),
                 std::span(hits).first(count));
    std::size_t going_on = 0;
    for (std::size_t i = 0; i < count; ++i) {
      if (!hits[i]) continue;
      const Hit& hit = *hits[i];
      const double distance = actor.start_m + hit.t;
      const auto sample_m = static_cast<float>(kSampleShare * distance * pixel_rad);
      const float alpha = opacity_at(actor.placed, hit, sample_m);
      if (alpha > 0) fragments[sample[i]].push_back({distance, actor_index, alpha, hit});
      through[sample[i]] *= 1.0 - alpha;
      if (alpha >= 1) continue;
      rays[going_on] = rays[i];
      dt_s[going_on] = dt_s[i];
      from_m[going_on] = hit.t + kStep;
      sample[going_on++] = sample[i];
    }
    count = going_on;
  }
  double stopped = 0;
  for (std::size_t i = 0; i < shots.size(); ++i) stopped += 1 - through[i];
  return stopped;
}

void Tracer::add(const Shot& shot,
                 double pixel_rad,
                 std::vector<Fragment>& fragments,
                 Sum& sum,
                 double* coverage) const {
  if (fragments.size() > 1)
    std::stable_sort(fragments.begin(), fragments.end(), [](const Fragment& a, const Fragment& b) {
      return a.distance_m < b.distance_m;
    });
  const double before = sum.alpha;
  blend(shot, pixel_rad, fragments, sum, coverage);
  ++sum.hits;
  sum.least = std::min(sum.least, sum.alpha - before);
  sum.most = std::max(sum.most, sum.alpha - before);
}

// Blends one sample's surfaces, nearest first.
void Tracer::blend(const Shot& shot,
                   double pixel_rad,
                   const std::vector<Fragment>& fragments,
                   Sum& sum,
                   double* coverage) const {
  double through = 1;
  const bool simple = fragments.front().alpha >= 1;
  const bool shades = simple ? sum.opaque_shaded < counts_.shaded
                             : sum.translucent_samples_shaded < kTranslucentShaded * counts_.shaded;
  std::array<double, 3> rgb_sum{};
  for (const Fragment& fragment : fragments) {
    const double share = through * fragment.alpha;
    coverage[static_cast<std::size_t>(fragment.actor)] += share;
    sum.alpha += share;
    sum.depth += share * fragment.distance_m;
    if (shades) {
      const std::array<float, 3> rgb = colour(shot, pixel_rad, fragment);
      for (std::size_t c = 0; c < 3; ++c) rgb_sum[c] += through * rgb[c];
    }
    through *= 1.0 - fragment.alpha;
    if (through <= 0) break;
  }
  (simple ? sum.opaque : sum.translucent) += 1 - through;
  if (!shades) return;
  for (std::size_t c = 0; c < 3; ++c)
    (simple ? sum.opaque_rgb : sum.translucent_rgb)[c] += rgb_sum[c];
  if (simple) {
    ++sum.opaque_shaded;
  } else {
    ++sum.translucent_samples_shaded;
    sum.translucent_shaded += 1 - through;
  }
}

std::array<float, 3> Tracer::colour(const Shot& shot,
                                    double pixel_rad,
                                    const Fragment& fragment) const {
  const TracedIntruder& actor = actors_[static_cast<std::size_t>(fragment.actor)];
  return shade(actor.placed,
               body_ray(actor, shot),
               fragment.hit,
               light_,
               footprint(fragment.distance_m, pixel_rad));
}

// The footprint of one shaded sample on the surface: the width of a pixel divided by the number of
// samples along a side.
float Tracer::footprint(double distance_m, double pixel_rad) const {
  return static_cast<float>(distance_m * pixel_rad /
                            std::sqrt(static_cast<double>(counts_.shaded)));
}

}  // namespace airtruth::render
