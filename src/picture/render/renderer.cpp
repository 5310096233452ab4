// SPDX-License-Identifier: Apache-2.0
#include "picture/render/renderer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <tbb/parallel_for.h>

#include "foundation/base/error.h"
#include "picture/render/refiner.h"
#include "picture/render/tracer.h"

namespace airtruth::render {
namespace {

// Samples along each side of the part of an aircraft that lies outside the frame.
constexpr int kAreaSamples = 64;

void write_pixel(const Canvas& canvas, std::size_t i, image::Layer& layer) {
  const Sum& sum = canvas.sums[i];
  if (sum.count == 0 || !(sum.alpha > 0)) return;
  const double n = sum.count;
  image::LayerPixel& pixel = layer.pixels[i];
  std::array<float, 3> rgb;
  for (std::size_t c = 0; c < 3; ++c) {
    const double opaque =
        sum.opaque_shaded > 0 ? sum.opaque_rgb[c] / sum.opaque_shaded * sum.opaque : 0.0;
    const double translucent =
        sum.translucent_shaded > 0
            ? sum.translucent_rgb[c] / sum.translucent_shaded * sum.translucent
            : 0.0;
    rgb[c] = static_cast<float>((opaque + translucent) / n);
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
    std::array<std::vector<Fragment>, 1> unused;
    for (int column = 0; column < kAreaSamples; ++column) {
      const Pixel p(x0 + (column + 0.5) * (x1 - x0) / kAreaSamples,
                    y0 + (row + 0.5) * (y1 - y0) / kAreaSamples);
      if (p.x() >= 0 && p.y() >= 0 && p.x() < view.width && p.y() < view.height) continue;
      const Vector3 direction = RayGrid::direction(view, p);
      if (!direction.allFinite()) continue;
      unused[0].clear();
      const std::array<Shot, 1> shot{Shot{direction, 0, 0}};
      rows[static_cast<std::size_t>(row)] += tracer.collect(actor, shot, 1e-3, unused);
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
    // The depth buffer of a large triangle in motion costs more than a few rays.
    counts.sees = counts.at_once;
  }
  const Tracer tracer(light, actors, grid, counts);
  image::Layer layer;
  if (patch) {
    Canvas canvas(*patch, actors.size());
    fill(view, actors, tracer, grid, counts, options.stop, canvas);
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
