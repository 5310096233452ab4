// SPDX-License-Identifier: Apache-2.0
#include "render/renderer.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "base/error.h"
#include "render/shade.h"

namespace airtruth::render {
namespace {

constexpr int kNeighbourSamples =
    128;  // of a pixel that looks whole beside an edge, before it is believed
constexpr int kShadedSamples = 16;  // hits per pixel whose light is computed; the others only count
constexpr float kStep = 1e-4f;      // past a translucent surface, metres
constexpr int kMaxLayers = 24;      // translucent surfaces along one ray
constexpr int kAreaSamples = 64;    // per side, of the part of an aircraft that the frame cuts off

struct Samples {
  int base = 16;
  int edge = 512;
};

Samples samples_for(int quality, double size_px) {
  switch (quality) {
    case 1:
      return {4, 32};
    case 2:
      return {16, 128};
    case 3:
      if (size_px <= 24) return {64, 1024};
      return size_px <= 64 ? Samples{16, 512} : Samples{16, 256};
    case 4:
      return {64, 1024};
    case 5:
      return {4096, 4096};
    default:
      break;
  }
  throw Error("render quality is " + std::to_string(quality) +
              "; expected 1 (draft) to 5 (oracle)");
}

std::uint32_t hashed(std::uint32_t x, std::uint32_t y) {
  std::uint32_t h = x * 0x9e3779b1u ^ (y + 0x7f4a7c15u) * 0x85ebca77u;
  h ^= h >> 16, h *= 0x7feb352du, h ^= h >> 15, h *= 0x846ca68bu, h ^= h >> 16;
  return h;
}

// The two-dimensional Sobol sequence (Sobol 1967), xor-scrambled by the pixel (Kollig and Keller
// 2002): any power of two of its points is a (0, 2)-net, which is what keeps the error of an edge
// small at every slope.
constexpr std::size_t kMostSamples = 4096;

std::array<std::array<std::uint32_t, 2>, kMostSamples> sobol_points() {
  std::array<std::array<std::uint32_t, 2>, kMostSamples> points{};
  for (std::uint32_t n = 0; n < kMostSamples; ++n) {
    std::uint32_t vx = 1u << 31;
    std::uint32_t vy = 1u << 31;
    for (std::uint32_t i = n; i != 0; i >>= 1, vx >>= 1, vy ^= vy >> 1) {
      if ((i & 1u) != 0) {
        points[n][0] ^= vx;
        points[n][1] ^= vy;
      }
    }
  }
  return points;
}

Eigen::Vector2d sobol(std::uint32_t i, std::uint32_t scramble_x, std::uint32_t scramble_y) {
  static const auto points = sobol_points();
  const auto& [x, y] = points[i];
  return {((x ^ scramble_x) + 0.5) * 0x1.0p-32, ((y ^ scramble_y) + 0.5) * 0x1.0p-32};
}

// Directions in world at the corners of the patch's pixels; NaN where the lens has none. Inside a
// pixel they are interpolated: over one pixel a lens is a plane to better than 1e-6 of its width.
class RayGrid {
 public:
  RayGrid(const View& view, const PixelBox& patch) : patch_(patch), width_(patch.width + 1) {
    directions_.resize(static_cast<std::size_t>(width_) *
                       static_cast<std::size_t>(patch.height + 1));
    tbb::parallel_for(0, patch.height + 1, [&](int row) {
      for (int column = 0; column < width_; ++column)
        directions_[index(column, row)] = direction(view, {patch.x + column, patch.y + row});
    });
  }
  static Vector3 direction(const View& view, const Pixel& pixel) {
    const Vector3 nominal = view.nominal_from_frame * Vector3(pixel.x(), pixel.y(), 1);
    const Vector3 nowhere = Vector3::Constant(std::numeric_limits<double>::quiet_NaN());
    if (!(nominal.z() > 0)) return nowhere;
    const auto ray =
        view.lens->ray_from_pixel({nominal.x() / nominal.z(), nominal.y() / nominal.z()});
    return ray ? Vector3(view.world_from_cam.rotation * *ray) : nowhere;
  }
  // Corners of a pixel: at (0,0), (1,0), (0,1), (1,1).
  std::array<Vector3, 4> corners(int x, int y) const {
    const int c = x - patch_.x;
    const int r = y - patch_.y;
    return {directions_[index(c, r)],
            directions_[index(c + 1, r)],
            directions_[index(c, r + 1)],
            directions_[index(c + 1, r + 1)]};
  }

 private:
  std::size_t index(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(width_) +
           static_cast<std::size_t>(column);
  }
  PixelBox patch_;
  int width_;
  std::vector<Vector3> directions_;
};

// One intruder, in its own coordinates.
struct Actor {
  Placed placed;
  Matrix3 body_from_world;
  Vector3 eye_in_body;
  double start_m =
      0;  // rays begin here, just before the sphere about the aircraft, so that floats suffice
  std::optional<PixelBox> pixels;
};

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
  if (search) {
    const double limit = 1e6;
    const int x0 = static_cast<int>(std::floor(std::clamp(search->x, -limit, limit)));
    const int y0 = static_cast<int>(std::floor(std::clamp(search->y, -limit, limit)));
    const int x1 = static_cast<int>(std::ceil(std::clamp(search->right(), -limit, limit)));
    const int y1 = static_cast<int>(std::ceil(std::clamp(search->bottom(), -limit, limit)));
    actor.pixels = intersection({x0, y0, x1 - x0, y1 - y0}, {0, 0, view.width, view.height});
  }
  return actor;
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

// A surface along a sample's ray.
struct Fragment {
  double distance_m = 0;
  int actor = 0;
  float alpha = 1;
  Hit hit;
};

// What a pixel's samples add up to.
struct Sum {
  std::array<double, 3> opaque_rgb{};  // of the shaded opaque samples
  int opaque_shaded = 0;
  double opaque = 0;  // samples' alpha that opaque surfaces contribute, not yet coloured
  std::array<double, 3> translucent_rgb{};
  double alpha = 0;
  double depth = 0;  // alpha-weighted
  double least = 1;  // smallest and largest opacity of the samples that hit
  double most = 0;
  int hits = 0;
  int count = 0;
};

class Painter {
 public:
  Painter(const Light& light, const std::vector<Actor>& actors, const RayGrid& grid)
      : light_(light), actors_(actors), grid_(grid) {}

  // Adds samples [from, to) of a pixel. `coverage` and `alone`: per actor.
  void sample(int x, int y, int from, int to, Sum& sum, double* coverage, double* alone) const {
    const auto corners = grid_.corners(x, y);
    sum.count += to - from;
    for (const Vector3& corner : corners)
      if (!corner.allFinite()) return;
    const std::uint32_t scramble_x =
        hashed(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y));
    const std::uint32_t scramble_y = hashed(scramble_x, 0x68bc21ebu);
    const double pixel_rad = (corners[1] - corners[0]).norm();
    std::vector<Fragment> fragments;
    for (int i = from; i < to; ++i) {
      const Eigen::Vector2d s = sobol(static_cast<std::uint32_t>(i), scramble_x, scramble_y);
      const Vector3 direction = ((1 - s.y()) * ((1 - s.x()) * corners[0] + s.x() * corners[1]) +
                                 s.y() * ((1 - s.x()) * corners[2] + s.x() * corners[3]))
                                    .normalized();
      fragments.clear();
      for (std::size_t a = 0; a < actors_.size(); ++a) {
        if (!actors_[a].pixels || !actors_[a].pixels->contains(x, y)) continue;
        const double seen = collect(static_cast<int>(a), direction, pixel_rad, fragments);
        alone[a] += seen;
      }
      if (!fragments.empty()) add(direction, pixel_rad, fragments, sum, coverage);
    }
  }

  // The share of a sample's light that one actor alone would stop; its surfaces are appended.
  double collect(int actor_index,
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
      const float alpha = opacity_at(actor.placed, *hit, static_cast<float>(distance * pixel_rad));
      if (alpha > 0) fragments.push_back({distance, actor_index, alpha, *hit});
      through *= 1.0 - alpha;
      if (alpha >= 1) break;
      from = hit->t + kStep;
    }
    return 1 - through;
  }

 private:
  static BodyRay body_ray(const Actor& actor, const Vector3& direction) {
    const Vector3 d = actor.body_from_world * direction;
    return {(actor.eye_in_body + actor.start_m * d).cast<float>(), d.cast<float>().normalized()};
  }

  void add(const Vector3& direction,
           double pixel_rad,
           std::vector<Fragment>& fragments,
           Sum& sum,
           double* coverage) const {
    if (fragments.size() > 1)
      std::stable_sort(
          fragments.begin(), fragments.end(), [](const Fragment& a, const Fragment& b) {
            return a.distance_m < b.distance_m;
          });
    const double before = sum.alpha;
    blend(direction, pixel_rad, fragments, sum, coverage);
    ++sum.hits;
    sum.least = std::min(sum.least, sum.alpha - before);
    sum.most = std::max(sum.most, sum.alpha - before);
  }

  // One sample's surfaces, nearest first, over one another.
  void blend(const Vector3& direction,
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
        if (sum.opaque_shaded < kShadedSamples) {
          const Shaded shaded = colour(direction, pixel_rad, fragment);
          for (std::size_t c = 0; c < 3; ++c) sum.opaque_rgb[c] += shaded.rgb[c];
          ++sum.opaque_shaded;
        }
        return;
      }
      const Shaded shaded = colour(direction, pixel_rad, fragment);
      for (std::size_t c = 0; c < 3; ++c) sum.translucent_rgb[c] += through * shaded.rgb[c];
      through *= 1.0 - fragment.alpha;
      if (through <= 0) return;
    }
  }

  Shaded colour(const Vector3& direction, double pixel_rad, const Fragment& fragment) const {
    const Actor& actor = actors_[static_cast<std::size_t>(fragment.actor)];
    return shade(actor.placed,
                 body_ray(actor, direction),
                 fragment.hit,
                 light_,
                 static_cast<float>(fragment.distance_m * pixel_rad));
  }

  const Light& light_;
  const std::vector<Actor>& actors_;
  const RayGrid& grid_;
};

// A patch's sums while it is refined.
struct Canvas {
  PixelBox patch;
  std::size_t actors = 0;
  std::vector<Sum> sums;
  std::vector<double> coverage;  // [pixel * actors + actor]
  std::vector<double> alone;

  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y - patch.y) * static_cast<std::size_t>(patch.width) +
           static_cast<std::size_t>(x - patch.x);
  }
};

void sample_pixel(const Painter& painter, Canvas& canvas, int x, int y, int from, int to) {
  const std::size_t i = canvas.index(x, y);
  double* coverage = canvas.coverage.data() + i * canvas.actors;
  double* alone = canvas.alone.data() + i * canvas.actors;
  painter.sample(x, y, from, to, canvas.sums[i], coverage, alone);
}

bool wanted(const std::vector<Actor>& actors, int x, int y) {
  return std::any_of(actors.begin(), actors.end(), [&](const Actor& a) {
    return a.pixels && a.pixels->contains(x, y);
  });
}

// Does the aircraft's outline, or that of something translucent, pass here or next door?
bool on_edge(const Canvas& canvas, const std::vector<std::uint8_t>& kind, int x, int y) {
  const std::uint8_t own = kind[canvas.index(x, y)];
  if (own == 2) return true;
  for (int j = std::max(y - 1, canvas.patch.y); j <= std::min(y + 1, canvas.patch.bottom() - 1);
       ++j) {
    for (int i = std::max(x - 1, canvas.patch.x); i <= std::min(x + 1, canvas.patch.right() - 1);
         ++i)
      if (kind[canvas.index(i, j)] != own) return true;
  }
  return false;
}

// 0: every sample missed; 1: every sample met one actor, at much the same opacity; 2: mixed.
std::uint8_t kind_of(const Canvas& canvas, std::size_t i) {
  const Sum& sum = canvas.sums[i];
  if (sum.hits == 0) return 0;
  constexpr double kEven = 0.1;
  if (sum.hits != sum.count || sum.most - sum.least > kEven) return 2;
  for (std::size_t a = 0; a < canvas.actors; ++a)
    if (canvas.coverage[i * canvas.actors + a] == sum.alpha) return 1;
  return 2;
}

std::vector<std::uint8_t> kinds(const Canvas& canvas) {
  std::vector<std::uint8_t> result(canvas.sums.size());
  for (std::size_t i = 0; i < result.size(); ++i) result[i] = kind_of(canvas, i);
  return result;
}

void write_pixel(const Canvas& canvas, std::size_t i, image::Layer& layer) {
  const Sum& sum = canvas.sums[i];
  if (sum.count == 0 || !(sum.alpha > 0)) return;
  const double n = sum.count;
  image::LayerPixel& pixel = layer.pixels[i];
  std::array<float, 3> rgb;
  for (std::size_t c = 0; c < 3; ++c) {
    const double opaque =
        sum.opaque_shaded > 0 ? sum.opaque_rgb[c] / sum.opaque_shaded * sum.opaque : 0.0;
    rgb[c] = static_cast<float>((opaque + sum.translucent_rgb[c]) / n);
  }
  pixel = {rgb[0], rgb[1], rgb[2], static_cast<float>(std::min(1.0, sum.alpha / n))};
  layer.depth_m[i] = static_cast<float>(sum.depth / sum.alpha);
  for (std::size_t a = 0; a < canvas.actors; ++a)
    if (!layer.coverage[a].empty())
      layer.coverage[a][i] = static_cast<float>(canvas.coverage[i * canvas.actors + a] / n);
}

// The part of the search box that lies outside the frame, sampled on a grid.
double area_outside(const View& view, const Painter& painter, int actor, const Box& search) {
  const double limit = 4.0 * std::max(view.width, view.height);
  const double x0 = std::max(search.x, -limit);
  const double y0 = std::max(search.y, -limit);
  const double x1 = std::min(search.right(), view.width + limit);
  const double y1 = std::min(search.bottom(), view.height + limit);
  if (x0 >= 0 && y0 >= 0 && x1 <= view.width && y1 <= view.height) return 0;
  const double cell = (x1 - x0) * (y1 - y0) / (kAreaSamples * kAreaSamples);
  std::vector<double> rows(kAreaSamples, 0.0);
  tbb::parallel_for(0, kAreaSamples, [&](int row) {
    std::vector<Fragment> unused;
    for (int column = 0; column < kAreaSamples; ++column) {
      const Pixel p(x0 + (column + 0.5) * (x1 - x0) / kAreaSamples,
                    y0 + (row + 0.5) * (y1 - y0) / kAreaSamples);
      if (p.x() >= 0 && p.y() >= 0 && p.x() < view.width && p.y() < view.height) continue;
      const Vector3 direction = RayGrid::direction(view, p);
      if (!direction.allFinite()) continue;
      unused.clear();
      rows[static_cast<std::size_t>(row)] += painter.collect(actor, direction, 1e-3, unused);
    }
  });
  double sum = 0;
  for (double row : rows) sum += row;
  return sum * cell;
}

std::optional<PixelBox> patch_of(const std::vector<Actor>& actors) {
  std::optional<PixelBox> patch;
  for (const Actor& actor : actors)
    if (actor.pixels) patch = patch ? bounds(*patch, *actor.pixels) : *actor.pixels;
  return patch;
}

double largest_px(const std::vector<Actor>& actors) {
  int largest = 0;
  for (const Actor& actor : actors)
    if (actor.pixels) largest = std::max({largest, actor.pixels->width, actor.pixels->height});
  return largest;
}

}  // namespace

Vector3 to_sun(double azimuth_deg, double elevation_deg) {
  const double a = radians(azimuth_deg);
  const double e = radians(elevation_deg);
  return {std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), -std::sin(e)};
}

image::Layer render(const View& view,
                    const Light& light,
                    const std::vector<Instance>& instances,
                    const std::vector<std::optional<Box>>& search,
                    const Options& options) {
  check(view.lens != nullptr && instances.size() == search.size(),
        "a view has a lens and an instance has its box");
  std::vector<Actor> actors;
  for (std::size_t i = 0; i < instances.size(); ++i)
    actors.push_back(place(instances[i], view, light, search[i]));
  image::Layer layer;
  layer.coverage.resize(actors.size());
  layer.area_alone_in_frame_px.assign(actors.size(), 0.0);
  layer.area_alone_px.assign(actors.size(), 0.0);
  const Samples samples = samples_for(options.quality, largest_px(actors));
  const auto patch = patch_of(actors);
  const RayGrid grid(view, patch.value_or(PixelBox{0, 0, 1, 1}));
  const Painter painter(light, actors, grid);
  if (patch) {
    Canvas canvas{*patch, actors.size(), {}, {}, {}};
    const auto count =
        static_cast<std::size_t>(patch->width) * static_cast<std::size_t>(patch->height);
    canvas.sums.resize(count);
    canvas.coverage.resize(count * actors.size());
    canvas.alone.resize(count * actors.size());
    const auto each_row = [&](const auto& body) {
      tbb::parallel_for(patch->y, patch->bottom(), [&](int y) {
        for (int x = patch->x; x < patch->right(); ++x)
          if (wanted(actors, x, y)) body(x, y);
      });
    };
    each_row([&](int x, int y) { sample_pixel(painter, canvas, x, y, 0, samples.base); });
    if (samples.edge > samples.base) {
      const auto kind = kinds(canvas);
      each_row([&](int x, int y) {
        if (!on_edge(canvas, kind, x, y)) return;
        const std::size_t i = canvas.index(x, y);
        int done = samples.base;
        if (kind[i] != 2 && samples.edge > kNeighbourSamples && samples.base < kNeighbourSamples) {
          done = kNeighbourSamples;
          sample_pixel(painter, canvas, x, y, samples.base, done);
          if (kind_of(canvas, i) == kind[i]) return;
        }
        sample_pixel(painter, canvas, x, y, done, samples.edge);
      });
    }
    layer.patch = *patch;
    layer.pixels.resize(count);
    layer.depth_m.assign(count, std::numeric_limits<float>::infinity());
    for (std::size_t a = 0; a < actors.size(); ++a)
      if (actors[a].pixels) layer.coverage[a].assign(count, 0.0f);
    for (std::size_t i = 0; i < count; ++i) {
      write_pixel(canvas, i, layer);
      for (std::size_t a = 0; a < actors.size(); ++a)
        if (canvas.sums[i].count > 0)
          layer.area_alone_in_frame_px[a] +=
              canvas.alone[i * actors.size() + a] / canvas.sums[i].count;
    }
  }
  for (std::size_t a = 0; a < actors.size(); ++a)
    if (search[a])
      layer.area_alone_px[a] = layer.area_alone_in_frame_px[a] +
                               area_outside(view, painter, static_cast<int>(a), *search[a]);
  return layer;
}

}  // namespace airtruth::render
