// SPDX-License-Identifier: Apache-2.0
#include "render/tracer.h"

#include <algorithm>
#include <cmath>

namespace airtruth::render {
namespace {

constexpr float kStep = 1e-4f;         // past a translucent surface, metres
constexpr double kSampleShare = 0.25;  // of a pixel's side, for one of the many samples of opacity
constexpr int kMaxLayers = 24;         // translucent surfaces along one ray

Vector3 interpolated(const std::array<Vector3, 4>& corners, const std::array<double, 2>& at) {
  const auto [x, y] = at;
  return ((1 - y) * ((1 - x) * corners[0] + x * corners[1]) +
          y * ((1 - x) * corners[2] + x * corners[3]))
      .normalized();
}

BodyRay body_ray(const Actor& actor, const Vector3& direction) {
  const Vector3 d = actor.body_from_world * direction;
  return {(actor.eye_in_body + actor.start_m * d).cast<float>(), d.cast<float>().normalized()};
}

std::optional<Hit> nearest_hit(const Placed& placed, const BodyRay& ray, float from) {
  std::optional<Hit> best;
  for (std::size_t i = 0; i < placed.model->scenes.size(); ++i) {
    const bool moves = placed.model->mesh.parts[i].spins;
    const Eigen::Vector3f o =
        moves ? Eigen::Vector3f(placed.part_from_body[i] * ray.origin) : ray.origin;
    const Eigen::Vector3f d =
        moves ? Eigen::Vector3f(placed.part_from_body[i].linear() * ray.direction) : ray.direction;
    RTCRayHit query{};
    query.ray.org_x = o.x(), query.ray.org_y = o.y(), query.ray.org_z = o.z();
    query.ray.dir_x = d.x(), query.ray.dir_y = d.y(), query.ray.dir_z = d.z();
    query.ray.tnear = from;
    query.ray.tfar = best ? best->t : INFINITY;
    query.ray.mask = 0xffffffffu;
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    rtcIntersect1(placed.model->scenes[i].get(), &context, &query);
    if (query.hit.geomID != RTC_INVALID_GEOMETRY_ID)
      best = Hit{query.ray.tfar, static_cast<int>(i), query.hit.primID, query.hit.u, query.hit.v};
  }
  return best;
}

// Within a few code values of one another, as a video would hold them?
bool alike(const std::array<float, 3>& low, const std::array<float, 3>& high) {
  constexpr float kSpread = 0.12f;
  for (std::size_t c = 0; c < 3; ++c)
    if (high[c] - low[c] > kSpread * high[c] + 0.004f) return false;
  return true;
}

}  // namespace

Actor place(const Instance& instance,
            const View& view,
            const Light& light,
            const std::optional<Box>& search) {
  Actor actor;
  const Model::Impl& model = instance.model->impl();
  actor.placed.model = &model;
  const Rigid body_from_world = instance.world_from_body.inverse();
  actor.body_from_world = body_from_world.rotation.toRotationMatrix();
  actor.eye_in_body = body_from_world * view.world_from_cam.translation;
  actor.start_m = std::max(0.0, (actor.eye_in_body - model.centre_in_body).norm() - model.radius_m);
  actor.placed.to_sun_in_body =
      (actor.body_from_world * light.to_sun_in_world).normalized().cast<float>();
  actor.placed.up_in_body = (actor.body_from_world * Vector3(0, 0, -1)).cast<float>();
  for (const aircraft::Part& part : model.mesh.parts) {
    actor.placed.body_from_part.push_back(aircraft::body_from_part(part, instance.time_s));
    actor.placed.part_from_body.push_back(actor.placed.body_from_part.back().inverse());
  }
  if (search) actor.pixels = intersection(pixels_of(*search), {0, 0, view.width, view.height});
  return actor;
}

bool finite(const std::array<Vector3, 4>& corners) {
  return std::all_of(
      corners.begin(), corners.end(), [](const Vector3& corner) { return corner.allFinite(); });
}

void Tracer::sample(
    int x, int y, int from, int to, Sum& sum, double* coverage, double* alone) const {
  const auto corners = grid_.corners(x, y);
  sum.count += to - from;
  if (!finite(corners)) return;
  const PixelSamples samples(x, y);
  const double pixel_rad = (corners[1] - corners[0]).norm();
  std::vector<Fragment> fragments;
  for (int i = from; i < to; ++i) {
    const Vector3 direction = interpolated(corners, samples.at(i));
    fragments.clear();
    for (std::size_t a = 0; a < actors_.size(); ++a) {
      if (!actors_[a].pixels || !actors_[a].pixels->contains(x, y)) continue;
      alone[a] += collect(static_cast<int>(a), direction, pixel_rad, fragments);
    }
    if (!fragments.empty()) add(direction, pixel_rad, fragments, sum, coverage);
  }
}

double Tracer::collect(int actor_index,
                       const Vector3& direction,
                       double pixel_rad,
                       std::vector<Fragment>& fragments) const {
  const Actor& actor = actors_[static_cast<std::size_t>(actor_index)];
  const BodyRay ray = body_ray(actor, direction);
  double through = 1;
  float from = 0;
  for (int layer = 0; layer < kMaxLayers; ++layer) {
    const auto hit = nearest_hit(actor.placed, ray, from);
    if (!hit) break;
    const double distance = actor.start_m + hit->t;
    const auto sample_m = static_cast<float>(kSampleShare * distance * pixel_rad);
    const float alpha = opacity_at(actor.placed, *hit, sample_m);
    if (alpha > 0) fragments.push_back({distance, actor_index, alpha, *hit});
    through *= 1.0 - alpha;
    if (alpha >= 1) break;
    from = hit->t + kStep;
  }
  return 1 - through;
}

bool Tracer::shade_covered(
    int x, int y, int actor_index, const std::vector<std::int32_t>& is_covered, Sum& sum) const {
  const Actor& actor = actors_[static_cast<std::size_t>(actor_index)];
  const auto corners = grid_.corners(x, y);
  const PixelSamples samples(x, y);
  const double pixel_rad = (corners[1] - corners[0]).norm();
  double distance_sum = 0;
  std::array<float, 3> low;
  low.fill(INFINITY);
  std::array<float, 3> high{};
  for (std::size_t i = 0; i < is_covered.size() && sum.opaque_shaded < counts_.shaded; ++i) {
    if (is_covered[i] == 0) continue;
    if (sum.opaque_shaded > 0 && sum.opaque_shaded % counts_.shaded_alike == 0 && alike(low, high))
      break;
    const Vector3 direction = interpolated(corners, samples.at(static_cast<int>(i)));
    const auto hit = nearest_hit(actor.placed, body_ray(actor, direction), 0);
    if (!hit) continue;  // a hair's breadth from an edge, where floats and doubles part
    const Fragment fragment{actor.start_m + hit->t, actor_index, 1, *hit};
    const std::array<float, 3> rgb = colour(direction, pixel_rad, fragment);
    for (std::size_t c = 0; c < 3; ++c) {
      sum.opaque_rgb[c] += rgb[c];
      low[c] = std::min(low[c], rgb[c]);
      high[c] = std::max(high[c], rgb[c]);
    }
    distance_sum += fragment.distance_m;
    ++sum.opaque_shaded;
  }
  if (sum.opaque_shaded == 0) return false;
  sum.depth = distance_sum / sum.opaque_shaded * sum.alpha;
  return true;
}

void Tracer::add(const Vector3& direction,
                 double pixel_rad,
                 std::vector<Fragment>& fragments,
                 Sum& sum,
                 double* coverage) const {
  if (fragments.size() > 1)
    std::stable_sort(fragments.begin(), fragments.end(), [](const Fragment& a, const Fragment& b) {
      return a.distance_m < b.distance_m;
    });
  const double before = sum.alpha;
  blend(direction, pixel_rad, fragments, sum, coverage);
  ++sum.hits;
  sum.least = std::min(sum.least, sum.alpha - before);
  sum.most = std::max(sum.most, sum.alpha - before);
}

// One sample's surfaces, nearest first, over one another.
void Tracer::blend(const Vector3& direction,
                   double pixel_rad,
                   const std::vector<Fragment>& fragments,
                   Sum& sum,
                   double* coverage) const {
  double through = 1;
  const bool simple = fragments.front().alpha >= 1;
  for (const Fragment& fragment : fragments) {
    const double share = through * fragment.alpha;
    coverage[static_cast<std::size_t>(fragment.actor)] += share;
    sum.alpha += share;
    sum.depth += share * fragment.distance_m;
    if (simple) {
      sum.opaque += share;
      if (sum.opaque_shaded < counts_.shaded) {
        const std::array<float, 3> rgb = colour(direction, pixel_rad, fragment);
        for (std::size_t c = 0; c < 3; ++c) sum.opaque_rgb[c] += rgb[c];
        ++sum.opaque_shaded;
      }
      return;
    }
    const std::array<float, 3> rgb = colour(direction, pixel_rad, fragment);
    for (std::size_t c = 0; c < 3; ++c) sum.translucent_rgb[c] += through * rgb[c];
    through *= 1.0 - fragment.alpha;
    if (through <= 0) return;
  }
}

std::array<float, 3> Tracer::colour(const Vector3& direction,
                                    double pixel_rad,
                                    const Fragment& fragment) const {
  const Actor& actor = actors_[static_cast<std::size_t>(fragment.actor)];
  return shade(actor.placed,
               body_ray(actor, direction),
               fragment.hit,
               light_,
               footprint(fragment.distance_m, pixel_rad));
}

// Of one shaded sample on the surface: a pixel's width shared out among the samples of a side.
float Tracer::footprint(double distance_m, double pixel_rad) const {
  return static_cast<float>(distance_m * pixel_rad /
                            std::sqrt(static_cast<double>(counts_.shaded)));
}

}  // namespace airtruth::render
