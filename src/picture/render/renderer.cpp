// SPDX-License-Identifier: Apache-2.0
#include "picture/render/renderer.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include "foundation/base/error.h"
#include "picture/render/samples.h"
#include "picture/render/shade_pixel.h"
#include "picture/shade/texture.h"
#include "picture/shade/trace.h"

namespace airtruth::render {
namespace {

// The reference of the tests, and what lies outside the frame: a ray of its own (Embree) for each
// sample, through the lens and the poses of the sample's time. It shares no code with the edge
// functions.

// Number of rays of a pixel whose surfaces are shaded: it bounds the time.
constexpr int kShaded = 64;

// A surface along a ray.
struct Fragment {
  double distance_m;
  std::size_t instance;
  float alpha;
  shade::Hit hit;
};

// The view and an aircraft at one moment.
class Then {
 public:
  Then(const View& view, double dt_s, const PlacedInstance& placed)
      : view_(view.at(dt_s)), placed_(placed) {
    const Instance& instance = placed.instance;
    body_from_world_ = carried(instance.world_from_body, instance.twist, dt_s).inverse();
    eye_in_body_ = body_from_world_ * view_.world_from_cam.translation;
    const shade::Model::Impl& model = *placed.placed.model;
    // Single precision suffices near the aircraft.
    start_m_ = std::max(0.0, (eye_in_body_ - model.centre_in_body).norm() - model.radius_m);
    for (const model::Part& part : model.mesh.parts)
      body_from_part_.push_back(model::body_from_part(part, instance.time_s + dt_s));
  }

  // Appends the surfaces that the ray through a point of the frame meets. Returns the share of
  // light that they stop.
  double collect(const Pixel& at,
                 double footprint_rad,
                 std::size_t index,
                 std::vector<Fragment>& fragments) const {
    // A step beyond a translucent surface, in metres, and the greatest number of those along one
    // ray.
    constexpr float kStepM = 1e-4f;
    constexpr int kMostLayers = 24;
    const Vector3 in_cam = ray_in_cam(view_, at);
    if (!in_cam.allFinite()) return 0;
    const shade::BodyRay ray = ray_of(in_cam);
    const shade::Model::Impl& model = *placed_.placed.model;
    double through = 1;
    float from_m = 0;
    for (int layer = 0; layer < kMostLayers; ++layer) {
      const auto hit = shade::nearest_hit(model, body_from_part_, ray, from_m);
      if (!hit) break;
      const shade::Facet& facet = placed_.placed.facet(*hit);
      const double distance_m = start_m_ + static_cast<double>(hit->t);
      const float alpha = shade::opacity_at(model.mesh,
                                            facet,
                                            placed_.placed.material(facet),
                                            hit->u,
                                            hit->v,
                                            static_cast<float>(distance_m * footprint_rad));
      if (alpha > 0) fragments.push_back({distance_m, index, alpha, *hit});
      through *= 1 - static_cast<double>(alpha);
      if (alpha >= 1) break;
      from_m = hit->t + kStepM;
    }
    return 1 - through;
  }

  image::Rgb colour(const Pixel& at,
                    const Fragment& fragment,
                    double footprint_rad,
                    const shade::Light& light) const {
    const shade::BodyRay ray = ray_of(ray_in_cam(view_, at));
    const shade::Placed& placed = placed_.placed;
    const shade::Hit& hit = fragment.hit;
    const shade::Facet& facet = placed.facet(hit);
    const model::Material& material = placed.material(facet);
    const shade::Surface surface = shade::surface_at(
        placed, body_from_part_[static_cast<std::size_t>(hit.part)], ray.direction, hit);
    const shade::Sunlit sunlit = shade::sunlit_at(placed, surface, material);
    const shade::BodyRay to_sun =
        shade::to_sun_from(placed, ray.origin + hit.t * ray.direction, surface);
    const bool in_shadow = !(sunlit.sun > 0) || shade::is_blocked(*placed.model, to_sun);
    const shade::TriangleTexture texture(
        placed.model->mesh, facet, static_cast<float>(fragment.distance_m * footprint_rad));
    return shade::colour_of({material,
                             texture.albedo(hit.u, hit.v),
                             shade::around_at(placed, surface, hit, light),
                             sunlit,
                             surface.cosine,
                             in_shadow},
                            light);
  }

 private:
  shade::BodyRay ray_of(const Vector3& in_cam) const {
    const Vector3 d =
        (body_from_world_.rotation * (view_.world_from_cam.rotation * in_cam)).normalized();
    return {(eye_in_body_ + start_m_ * d).cast<float>(), d.cast<float>().normalized()};
  }

  View view_;
  const PlacedInstance& placed_;
  Rigid body_from_world_;
  Vector3 eye_in_body_;
  double start_m_ = 0;
  std::vector<Eigen::Affine3f> body_from_part_;
};

// Adds what one sample sees to a pixel.
void blend(std::vector<Fragment>& fragments,
           const std::vector<Then>& now,
           const Pixel& at,
           double footprint_rad,
           const shade::Light* light,
           RenderedPixel& pixel) {
  // Share of one sample in a pixel.
  constexpr double kShare = 1.0 / PixelSamples::kMost;
  std::stable_sort(fragments.begin(), fragments.end(), [](const Fragment& a, const Fragment& b) {
    return a.distance_m < b.distance_m;
  });
  double through = 1;
  for (const Fragment& fragment : fragments) {
    const double share = kShare * through * static_cast<double>(fragment.alpha);
    pixel.coverage[fragment.instance] += share;
    pixel.alpha += share;
    pixel.light.distance_m += share * fragment.distance_m;
    if (light != nullptr) {
      const image::Rgb rgb = now[fragment.instance].colour(at, fragment, footprint_rad, *light);
      for (std::size_t c = 0; c < 3; ++c)
        pixel.light.rgb[c] += through * static_cast<double>(rgb[c]);
    }
    through *= 1 - static_cast<double>(fragment.alpha);
    if (through <= 0) break;
  }
}

// What rays through a pixel meet.
RenderedPixel trace_pixel(const View& view,
                          const shade::Light& light,
                          const std::vector<PlacedInstance>& instances,
                          int x,
                          int y) {
  // Footprints of a sample of opacity and of one that is shaded, as shares of the pixel's side.
  constexpr double kOpacityShare = 0.25;
  const double shaded_share = 1 / std::sqrt(static_cast<double>(kShaded));
  RenderedPixel pixel;
  pixel.coverage.assign(instances.size(), 0.0);
  pixel.alone.assign(instances.size(), 0.0);
  const PixelSamples samples(x, y);
  const double middle_s = view.shutter.middle_s({double(x), double(y)}, view.width, view.height);
  const double exposure_s = std::max(0.0, view.shutter.exposure_s);
  const auto then = [&](double dt_s) {
    std::vector<Then> result;
    for (const PlacedInstance& placed : instances) result.emplace_back(view, dt_s, placed);
    return result;
  };
  const View middle_view = view.at(middle_s);
  const double pixel_rad =
      (ray_in_cam(middle_view, {x + 1.0, y + 0.5}) - ray_in_cam(middle_view, {x + 0.0, y + 0.5}))
          .norm();
  std::vector<Then> now = then(middle_s);
  std::vector<Fragment> fragments;
  int shaded = 0;
  double shaded_alpha = 0;
  for (int i = 0; i < PixelSamples::kMost; ++i) {
    const auto [u, v, t] = samples.at(i);
    if (exposure_s > 0) now = then(middle_s + exposure_s * (t - 0.5));
    const Pixel at(x + u, y + v);
    fragments.clear();
    for (std::size_t a = 0; a < instances.size(); ++a)
      if (instances[a].pixels && instances[a].pixels->contains(x, y))
        pixel.alone[a] +=
            now[a].collect(at, kOpacityShare * pixel_rad, a, fragments) / PixelSamples::kMost;
    if (fragments.empty()) continue;
    const bool shades = shaded < kShaded;
    const double before = pixel.alpha;
    blend(fragments, now, at, shaded_share * pixel_rad, shades ? &light : nullptr, pixel);
    if (!shades) continue;
    ++shaded;
    shaded_alpha += pixel.alpha - before;
  }
  // The shaded samples stand for all.
  if (shaded_alpha > 0)
    for (double& channel : pixel.light.rgb)
      channel *= pixel.alpha / (shaded_alpha * PixelSamples::kMost);
  return pixel;
}

// The area in pixels that an instance covers outside the frame, within its search box. What lies
// beside the frame has the time of its own row (column), or else of the nearest.
double area_outside(const View& view, const PlacedInstance& placed, const Box& search) {
  // Samples along each side of the search box.
  constexpr int kSide = 64;
  const double limit = 4.0 * std::max(view.width, view.height);
  const double x0 = std::max(search.x, -limit);
  const double y0 = std::max(search.y, -limit);
  const double x1 = std::min(search.right(), view.width + limit);
  const double y1 = std::min(search.bottom(), view.height + limit);
  if (x0 >= 0 && y0 >= 0 && x1 <= view.width && y1 <= view.height) return 0;
  const Shutter& shutter = view.shutter;
  const bool is_by_column = shutter.readout == Readout::kRight || shutter.readout == Readout::kLeft;
  const auto sample = [&](int line, int place) -> Pixel {
    const auto [column, row] = is_by_column ? std::pair(line, place) : std::pair(place, line);
    return {x0 + (column + 0.5) * (x1 - x0) / kSide, y0 + (row + 0.5) * (y1 - y0) / kSide};
  };
  std::vector<double> lines(kSide, 0.0);
  tbb::parallel_for(0, kSide, [&](int line) {
    const Pixel first = sample(line, 0);
    const Pixel inside(std::clamp(first.x(), 0.0, view.width - 1.0),
                       std::clamp(first.y(), 0.0, view.height - 1.0));
    // The times of all lines divide the exposure evenly.
    const double into_exposure_s =
        std::max(0.0, shutter.exposure_s) * (PixelSamples(0, 0).at(line)[2] - 0.5);
    const Then then(
        view, shutter.middle_s(inside, view.width, view.height) + into_exposure_s, placed);
    std::vector<Fragment> unused;
    for (int place = 0; place < kSide; ++place) {
      const Pixel p = sample(line, place);
      if (p.x() >= 0 && p.y() >= 0 && p.x() < view.width && p.y() < view.height) continue;
      unused.clear();
      lines[static_cast<std::size_t>(line)] += then.collect(p, 0, 0, unused);
    }
  });
  return std::accumulate(lines.begin(), lines.end(), 0.0) * (x1 - x0) * (y1 - y0) / (kSide * kSide);
}

image::Layer empty_layer(const PixelBox& patch, const std::vector<PlacedInstance>& instances) {
  image::Layer layer(patch);
  layer.coverage.resize(instances.size());
  for (std::size_t i = 0; i < instances.size(); ++i)
    if (instances[i].pixels) layer.coverage[i] = image::Coverage(*instances[i].pixels);
  layer.areas.resize(instances.size());
  return layer;
}

// Fills the pixels of a layer.
struct Painter {
  const View& view;
  const shade::Light& light;
  std::vector<PlacedInstance>& instances;
  const PixelRays& rays;
  const std::stop_token& stop;
  image::Layer& layer;
  // By instance: as layer.coverage, without occlusion.
  std::vector<std::vector<double>> alone = {};

  void paint(const SampleCounts& counts) {
    for (const image::Coverage& coverage : layer.coverage)
      alone.emplace_back(coverage.alpha.size(), 0.0);
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
    tbb::parallel_for(layer.patch.y, layer.patch.bottom(), [&](int y) {
      if (!stop.stop_requested()) row(y);
    });
  }

  void trace() {
    each_row([&](int y) {
      for (int x = layer.patch.x; x < layer.patch.right() && !stop.stop_requested(); ++x) {
        const RenderedPixel pixel = trace_pixel(view, light, instances, x, y);
        if (pixel.alpha > 0) write(x, y, pixel);
      }
    });
  }

  void rasterise(const SampleCounts& counts) {
    const PixelBox& patch = layer.patch;
    const RayTriangles triangles(view, patch, rays.span(), instances);
    tbb::enumerable_thread_specific<Scratch> scratch([&] {
      return Scratch{{triangles, instances, rays, counts}, {instances, rays, light}, {}};
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
    pixel.coverage.assign(instances.size(), 0.0);
    for (const VisibleSurface& surface : visibility.surfaces())
      pixel.coverage[visibility.triangle(surface.candidate).instance] +=
          static_cast<double>(surface.weight);
    pixel.alone = pixel.coverage;
    if (visibility.has_several())
      for (std::uint32_t i = 0; i < instances.size(); ++i) pixel.alone[i] = visibility.alpha_of(i);
    write(x, y, pixel);
  }

  void write(int x, int y, const RenderedPixel& pixel) {
    const auto& [rgb, distance_m] = pixel.light;
    const std::size_t i = layer.index(x, y);
    layer.pixels[i] = {static_cast<float>(rgb[0]),
                       static_cast<float>(rgb[1]),
                       static_cast<float>(rgb[2]),
                       static_cast<float>(std::min(1.0, pixel.alpha))};
    layer.depth_m[i] = static_cast<float>(distance_m / pixel.alpha);
    for (std::size_t a = 0; a < instances.size(); ++a) {
      image::Coverage& of = layer.coverage[a];
      if (!of.box.contains(x, y)) continue;
      of.alpha[of.index(x, y)] = static_cast<float>(pixel.coverage[a]);
      alone[a][of.index(x, y)] = pixel.alone[a];
    }
  }

  void add_areas() {
    for (std::size_t a = 0; a < instances.size(); ++a) {
      image::Areas& areas = layer.areas[a];
      for (const float share : layer.coverage[a].alpha) areas.seen_px += static_cast<double>(share);
      for (const double share : alone[a]) areas.alone_in_frame_px += share;
      areas.free_px = areas.clear_px = areas.seen_px;
      areas.alone_px = areas.alone_in_frame_px;
    }
  }
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
    Painter{view, light, placed, rays, options.stop, layer}.paint(counts);
  }
  for (std::size_t a = 0; a < placed.size(); ++a)
    if (search[a]) layer.areas[a].alone_px += area_outside(view, placed[a], *search[a]);
  return layer;
}

}  // namespace airtruth::render
