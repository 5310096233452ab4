// SPDX-License-Identifier: Apache-2.0
#include "picture/render/renderer.h"

#include <algorithm>
#include <cmath>

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include "foundation/base/error.h"
#include "picture/render/reference.h"
#include "picture/render/shade_pixel.h"

namespace airtruth::render {
namespace {

image::Layer empty_layer(const PixelBox& patch, const std::vector<PlacedInstance>& instances) {
  image::Layer layer(patch);
  layer.coverage.resize(instances.size());
  for (std::size_t i = 0; i < instances.size(); ++i)
    if (instances[i].pixels) layer.coverage[i] = image::Coverage(*instances[i].pixels);
  layer.areas.resize(instances.size());
  return layer;
}

// Fills the pixels of a layer.
class Painter {
 public:
  Painter(const View& view,
          const shade::Light& light,
          std::vector<PlacedInstance>& instances,
          const PixelRays& rays,
          const std::stop_token& stop,
          image::Layer& layer)
      : view_(view),
        light_(light),
        instances_(instances),
        rays_(rays),
        stop_(stop),
        layer_(layer),
        alone_(instances.size()) {
    for (std::size_t a = 0; a < alone_.size(); ++a)
      alone_[a].assign(layer.coverage[a].alpha.size(), 0.0);
  }

  void paint(const SampleCounts& counts) {
    if (counts.by_rays)
      trace();
    else
      rasterise(counts);
    add_areas();
  }

 private:
  // What a thread keeps from one pixel to the next.
  struct Scratch {
    Visibility visibility;
    PixelShading shading;
    RenderedPixel pixel;
  };

  template <typename Row>
  void each_row(const Row& row) {
    tbb::parallel_for(layer_.patch.y, layer_.patch.bottom(), [&](int y) {
      if (!stop_.stop_requested()) row(y);
    });
  }

  void trace() {
    each_row([&](int y) {
      for (int x = layer_.patch.x; x < layer_.patch.right() && !stop_.stop_requested(); ++x) {
        const RenderedPixel pixel = trace_pixel(view_, light_, instances_, x, y);
        if (pixel.alpha > 0) write(x, y, pixel);
      }
    });
  }

  void rasterise(const SampleCounts& counts) {
    const PixelBox& patch = layer_.patch;
    const RayTriangles triangles(view_, patch, rays_.span(), instances_);
    tbb::enumerable_thread_specific<Scratch> scratch([&] {
      return Scratch{
          {triangles, instances_, rays_, counts}, {triangles, instances_, rays_, light_}, {}};
    });
    each_row([&](int y) {
      Scratch& here = scratch.local();
      here.visibility.begin_row(y, patch.x, patch.right());
      for (int x = patch.x; x < patch.right(); ++x) {
        here.visibility.look(x);
        if (here.visibility.alpha() > 0) finish(x, y, here);
      }
    });
  }

  void finish(int x, int y, Scratch& scratch) {
    auto& [visibility, shading, pixel] = scratch;
    pixel.light = shading.light_of(visibility, x, y);
    pixel.alpha = visibility.alpha();
    pixel.coverage.assign(instances_.size(), 0.0);
    for (const VisibleSurface& surface : visibility.surfaces())
      pixel.coverage[visibility.instance_of(surface)] += static_cast<double>(surface.weight);
    pixel.alone = pixel.coverage;
    if (visibility.has_several())
      for (std::uint32_t i = 0; i < instances_.size(); ++i) pixel.alone[i] = visibility.alpha_of(i);
    write(x, y, pixel);
  }

  void write(int x, int y, const RenderedPixel& pixel) {
    const auto& [rgb, distance_m] = pixel.light;
    const std::size_t i = layer_.index(x, y);
    layer_.pixels[i] = {static_cast<float>(rgb[0]),
                        static_cast<float>(rgb[1]),
                        static_cast<float>(rgb[2]),
                        static_cast<float>(std::min(1.0, pixel.alpha))};
    layer_.depth_m[i] = static_cast<float>(distance_m / pixel.alpha);
    for (std::size_t a = 0; a < instances_.size(); ++a) {
      image::Coverage& of = layer_.coverage[a];
      if (!of.box.contains(x, y)) continue;
      of.alpha[of.index(x, y)] = static_cast<float>(pixel.coverage[a]);
      alone_[a][of.index(x, y)] = pixel.alone[a];
    }
  }

  void add_areas() {
    for (std::size_t a = 0; a < instances_.size(); ++a) {
      image::Areas& areas = layer_.areas[a];
      for (const float share : layer_.coverage[a].alpha)
        areas.seen_px += static_cast<double>(share);
      for (const double share : alone_[a]) areas.alone_in_frame_px += share;
      areas.free_px = areas.clear_px = areas.seen_px;
      areas.alone_px = areas.alone_in_frame_px;
    }
  }

  const View& view_;
  const shade::Light& light_;
  std::vector<PlacedInstance>& instances_;
  const PixelRays& rays_;
  const std::stop_token& stop_;
  image::Layer& layer_;
  // By instance: as layer_.coverage, without occlusion.
  std::vector<std::vector<double>> alone_;
};

}  // namespace

image::Layer render(const View& view,
                    const shade::Light& light,
                    const std::vector<Instance>& instances,
                    const std::vector<std::optional<Box>>& search,
                    const Options& options) {
  check(view.lens != nullptr && instances.size() == search.size(),
        "a view has a lens and an instance has its box");
  const SampleCounts counts = counts_for(options.quality, view.shutter.exposure_s > 0);
  std::optional<PixelBox> patch;
  for (const auto& box : search)
    if (const auto pixels = pixels_to_search(box, view))
      patch = patch ? bounds(*patch, *pixels) : *pixels;
  const Span span = span_of(view, patch.value_or(PixelBox{0, 0, 1, 1}));
  std::vector<PlacedInstance> placed;
  for (std::size_t i = 0; i < instances.size(); ++i)
    placed.push_back(place(instances[i], view, light, search[i], span));
  image::Layer layer = empty_layer(patch.value_or(PixelBox{}), placed);
  if (patch) {
    const PixelRays rays(view, *patch);
    Painter(view, light, placed, rays, options.stop, layer).paint(counts);
  }
  for (std::size_t a = 0; a < placed.size(); ++a)
    if (search[a]) layer.areas[a].alone_px += area_outside(view, placed[a], *search[a]);
  return layer;
}

}  // namespace airtruth::render
