// SPDX-License-Identifier: Apache-2.0
#include "picture/render/renderer.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <tbb/parallel_for.h>

#include "foundation/base/error.h"
#include "picture/render/silhouette.h"
#include "picture/render/tracer.h"

namespace airtruth::render {
namespace {

// Samples of a pixel beside an edge before it counts as fully covered or empty.
constexpr int kNeighbourSamples = 128;
// Samples along each side of the part of an aircraft that lies outside the frame.
constexpr int kAreaSamples = 64;

// The sums of a patch during its refinement.
struct Canvas {
  Canvas(const PixelBox& where, std::size_t actor_count)
      : patch(where),
        actors(actor_count),
        sums(static_cast<std::size_t>(where.width) * static_cast<std::size_t>(where.height)),
        coverage(sums.size() * actor_count),
        alone(sums.size() * actor_count) {}

  PixelBox patch;
  std::size_t actors;
  std::vector<Sum> sums;
  // Index: pixel * actors + actor.
  std::vector<double> coverage;
  std::vector<double> alone;

  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y - patch.y) * static_cast<std::size_t>(patch.width) +
           static_cast<std::size_t>(x - patch.x);
  }
};

void sample_pixel(const Tracer& tracer, Canvas& canvas, int x, int y, int from, int to) {
  const std::size_t i = canvas.index(x, y);
  double* coverage = canvas.coverage.data() + i * canvas.actors;
  double* alone = canvas.alone.data() + i * canvas.actors;
  tracer.sample(x, y, from, to, canvas.sums[i], coverage, alone);
}

// True where an outline of the aircraft, or of a translucent surface, passes through this pixel or
// a neighbour.
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

// Value 0: every sample missed. 1: every sample hit one actor, at nearly the same opacity. 2:
// mixed.
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
double area_outside(const View& view, const Tracer& tracer, int actor, const Box& search) {
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
      rows[static_cast<std::size_t>(row)] += tracer.collect(actor, {direction, 0, 0}, 1e-3, unused);
    }
  });
  double sum = 0;
  for (double row : rows) sum += row;
  return sum * cell;
}

std::optional<PixelBox> patch_of(const std::vector<std::optional<Box>>& search, const View& view) {
  std::optional<PixelBox> patch;
  for (const auto& box : search)
    if (const auto pixels = pixels_to_search(box, view))
      patch = patch ? bounds(*patch, *pixels) : *pixels;
  return patch;
}

double largest_px(const std::vector<TracedIntruder>& actors) {
  int largest = 0;
  for (const TracedIntruder& actor : actors)
    if (actor.pixels) largest = std::max({largest, actor.pixels->width, actor.pixels->height});
  return largest;
}

// Fills a canvas: first every pixel that an aircraft may touch, with few samples, then those on an
// outline, with many.
class Refiner {
 public:
  Refiner(const View& view,
          const std::vector<TracedIntruder>& actors,
          const Tracer& tracer,
          const RayGrid& grid,
          const SampleCounts& counts,
          Canvas& canvas)
      : actors_(actors), tracer_(tracer), counts_(counts), canvas_(canvas) {
    // Where every pixel takes as many samples as an edge (the reference quality), rays do all the
    // work.
    if (counts.edge == counts.base) return;
    for (const TracedIntruder& actor : actors)
      silhouettes_.push_back(
          actor.pixels ? std::optional<Silhouette>(std::in_place, actor, view, canvas.patch, grid)
                       : std::nullopt);
  }

  void fill(const std::stop_token& stop) {
    each_pixel(stop, [&](int x, int y) { rough(x, y); });
    if (counts_.edge == counts_.base) return;
    const std::vector<std::uint8_t> kind = kinds(canvas_);
    each_pixel(stop, [&](int x, int y) { refine(x, y, kind); });
  }

 private:
  static constexpr int kRays = -1;
  static constexpr int kNobody = -2;

  // The single opaque actor whose outline determines the pixel, or kRays, or kNobody.
  int only_actor(int x, int y) const {
    int only = kNobody;
    for (std::size_t a = 0; a < actors_.size(); ++a) {
      if (!actors_[a].pixels || !actors_[a].pixels->contains(x, y)) continue;
      if (silhouettes_.empty()) return kRays;
      const Silhouette::Touch touch = silhouettes_[a]->touch(x, y);
      if (touch == Silhouette::Touch::kNone) continue;
      if (touch == Silhouette::Touch::kRays || only != kNobody) return kRays;
      only = static_cast<int>(a);
    }
    return only;
  }

  template <typename Body>
  void each_pixel(const std::stop_token& stop, const Body& body) {
    tbb::parallel_for(canvas_.patch.y, canvas_.patch.bottom(), [&](int y) {
      for (int x = canvas_.patch.x; x < canvas_.patch.right() && !stop.stop_requested(); ++x)
        body(x, y);
    });
  }

  void rough(int x, int y) {
    const int only = only_actor(x, y);
    if (only == kNobody) return;
    if (only == kRays)
      sample_pixel(tracer_, canvas_, x, y, 0, counts_.base);
    else if (counts_.at_once)
      shade(x, y, only, &cover(x, y, only, counts_.outline));
    else
      cover(x, y, only, kRoughCover);
  }

  void refine(int x, int y, const std::vector<std::uint8_t>& kind) {
    const int only = only_actor(x, y);
    if (only == kNobody) return;
    const bool edge = on_edge(canvas_, kind, x, y);
    if (only == kRays) {
      if (edge) refine_by_rays(x, y, kind[canvas_.index(x, y)]);
      return;
    }
    if (!counts_.at_once) shade(x, y, only, edge ? &cover(x, y, only, counts_.outline) : nullptr);
  }

  // `found`: of the pixel; null: every sample is covered, or none.
  void shade(int x, int y, int only, const Cover* found) {
    static const std::vector<std::int32_t> kEverySample(kRoughCover, -1);
    Sum& sum = canvas_.sums[canvas_.index(x, y)];
    if (sum.hits == 0 ||
        tracer_.shade_covered(x, y, only, found ? found->is_covered : kEverySample, sum))
      return;
    // The outline covers a sample, but no ray hits.
    forget(x, y, only);
    sample_pixel(tracer_, canvas_, x, y, 0, counts_.edge);
  }

  void refine_by_rays(int x, int y, std::uint8_t kind) {
    const std::size_t i = canvas_.index(x, y);
    int done = canvas_.sums[i].count;
    if (kind != 2 && counts_.edge > kNeighbourSamples && done < kNeighbourSamples) {
      sample_pixel(tracer_, canvas_, x, y, done, kNeighbourSamples);
      done = kNeighbourSamples;
      if (kind_of(canvas_, i) == kind) return;
    }
    sample_pixel(tracer_, canvas_, x, y, done, counts_.edge);
  }

  // Covers a pixel by the outline of its single actor, without its light. The result is valid until
  // the next call on this thread.
  const Cover& cover(int x, int y, int actor, int samples) {
    thread_local Cover found;
    found.covered = 0;
    silhouettes_[static_cast<std::size_t>(actor)]->cover(x, y, samples, found);
    const std::size_t i = canvas_.index(x, y);
    Sum& sum = canvas_.sums[i];
    sum = {};
    sum.count = samples;
    sum.hits = found.covered;
    sum.least = sum.most = 1;
    sum.alpha = sum.opaque = found.covered;
    const std::size_t of_actor = i * canvas_.actors + static_cast<std::size_t>(actor);
    canvas_.coverage[of_actor] = canvas_.alone[of_actor] = found.covered;
    return found;
  }

  void forget(int x, int y, int actor) {
    const std::size_t i = canvas_.index(x, y);
    const std::size_t of_actor = i * canvas_.actors + static_cast<std::size_t>(actor);
    canvas_.sums[i] = {};
    canvas_.coverage[of_actor] = canvas_.alone[of_actor] = 0;
  }

  static constexpr int kRoughCover = 64;

  const std::vector<TracedIntruder>& actors_;
  const Tracer& tracer_;
  SampleCounts counts_;
  Canvas& canvas_;
  std::vector<std::optional<Silhouette>> silhouettes_;
};

image::Layer layer_of(const Canvas& canvas, const std::vector<TracedIntruder>& actors) {
  image::Layer layer;
  layer.patch = canvas.patch;
  layer.pixels.resize(canvas.sums.size());
  layer.depth_m.assign(canvas.sums.size(), std::numeric_limits<float>::infinity());
  layer.coverage.resize(actors.size());
  layer.area_alone_in_frame_px.assign(actors.size(), 0.0);
  layer.area_seen_px.assign(actors.size(), 0.0);
  for (std::size_t a = 0; a < actors.size(); ++a)
    if (actors[a].pixels) layer.coverage[a].assign(canvas.sums.size(), 0.0f);
  for (std::size_t i = 0; i < canvas.sums.size(); ++i) {
    write_pixel(canvas, i, layer);
    if (canvas.sums[i].count == 0) continue;
    for (std::size_t a = 0; a < actors.size(); ++a) {
      const std::size_t of_actor = i * actors.size() + a;
      layer.area_alone_in_frame_px[a] += canvas.alone[of_actor] / canvas.sums[i].count;
      layer.area_seen_px[a] += canvas.coverage[of_actor] / canvas.sums[i].count;
    }
  }
  return layer;
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
  const auto patch = patch_of(search, view);
  const RayGrid grid(view, patch.value_or(PixelBox{0, 0, 1, 1}));
  std::vector<TracedIntruder> actors;
  for (std::size_t i = 0; i < instances.size(); ++i)
    actors.push_back(place(instances[i], view, light, search[i], grid.span()));
  SampleCounts counts = counts_for(options.quality, largest_px(actors));
  // The samples have a third dimension, time, and need a larger number for the same error.
  if (view.shutter.exposure_s > 0) {
    counts.outline = std::min(2 * counts.outline, PixelSamples::kMost);
    counts.at_once = false;
  }
  const Tracer tracer(light, actors, grid, counts);
  image::Layer layer;
  if (patch) {
    Canvas canvas(*patch, actors.size());
    Refiner(view, actors, tracer, grid, counts, canvas).fill(options.stop);
    layer = layer_of(canvas, actors);
  } else {
    layer.coverage.resize(actors.size());
    layer.area_alone_in_frame_px.assign(actors.size(), 0.0);
    layer.area_seen_px.assign(actors.size(), 0.0);
  }
  layer.area_free_px = layer.area_seen_px;
  layer.area_alone_px = layer.area_alone_in_frame_px;
  for (std::size_t a = 0; a < actors.size(); ++a)
    if (search[a])
      layer.area_alone_px[a] += area_outside(view, tracer, static_cast<int>(a), *search[a]);
  return layer;
}

}  // namespace airtruth::render
