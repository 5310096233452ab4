// SPDX-License-Identifier: Apache-2.0
#include "sequence/insertion/paint.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "foundation/base/error.h"
#include "foundation/geometry/box.h"
#include "picture/composite/chroma_key.h"
#include "picture/composite/codec_blocks.h"
#include "picture/composite/cover.h"
#include "picture/composite/spots.h"
#include "picture/composite/spread.h"
#include "picture/video/still.h"
#include "scene/scene/camera_keys.h"
#include "sequence/setup/from_scene.h"

namespace airtruth::insertion {
namespace {

bool is_by_key(const scene::Scene& scene) {
  return scene.composite.method == scene::CompositeMethod::kChromaKey;
}

// Distance beyond the light of the intruder within which the layer's samples change.
int margin_px(const scene::CameraModel& model) {
  return setup::sensor_of(model).reach_px() +
         (setup::has_codec(model) ? composite::kCodecBlockPx - 1 : 0);
}

// Effects of air and lens on the light that has left the intruder.
image::Layer through_air_and_lens(image::Layer layer,
                                  const scene::CameraModel& model,
                                  const Ambient& ambient,
                                  const lens::ImageSize& size) {
  if (layer.empty()) return layer;
  if (model.extinction_per_km) {
    std::array<double, 3> airlight;
    for (std::size_t c = 0; c < 3; ++c)
      airlight[c] = model.airlight ? (*model.airlight)[c] : double(ambient.airlight[c]);
    composite::add_haze(layer, *model.extinction_per_km, airlight);
  }
  const double across_px = model.point_spread_px.value_or(0);
  const composite::PointSpread point_spread{
      across_px, std::hypot(across_px, model.vertical_spread_px.value_or(0))};
  return composite::spread(layer, point_spread, margin_px(model), size.width, size.height);
}

// The light of the clip, changed by [weather]. What the air between adds stays the clip's.
shade::Light light_on_intruders(const scene::Scene& scene, const Ambient& ambient) {
  shade::Light light{setup::to_sun_in_world(scene.light),
                     ambient.sun,
                     ambient.sky(),
                     ambient.ground,
                     is_by_key(scene) ? std::nullopt : std::optional(ambient.surroundings)};
  if (!scene::states_any_key(scene.weather)) return light;
  const double exposure = scene.weather.exposure.value_or(1);
  const double red = std::sqrt(scene.weather.white_balance.value_or(1));
  const std::array by = {static_cast<float>(exposure * red),
                         static_cast<float>(exposure),
                         static_cast<float>(exposure / red)};
  const auto sun_share = static_cast<float>(scene.weather.sun_share.value_or(1));
  for (std::size_t c = 0; c < 3; ++c) {
    light.sun[c] *= by[c] * sun_share;
    light.sky[c] *= by[c];
    light.ground[c] *= by[c];
  }
  if (light.surroundings) light.surroundings = light.surroundings->scaled({by[0], by[1], by[2]});
  return light;
}

bool differs(const image::Picture& a, const image::Picture& b, int x, int y) {
  if (a.planes[0].row(y)[x] != b.planes[0].row(y)[x]) return true;
  if (a.plane_count == 1) return false;
  const int cx = x >> image::log2_chroma_width(a.colour.chroma);
  const int cy = y >> image::log2_chroma_height(a.colour.chroma);
  return a.planes[1].row(cy)[cx] != b.planes[1].row(cy)[cx] ||
         a.planes[2].row(cy)[cx] != b.planes[2].row(cy)[cx];
}

// Reach of the Lanczos kernel: its 8x8 samples spread an edge by four pixels.
constexpr int kLanczosReachPx = 5;

// Rows and columns from a pixel to the nearest that intruder i covers; one more than the kernel
// reaches: it covers none so near.
int distance_px(const image::Layer& layer, std::size_t i, int x, int y) {
  int nearest = kLanczosReachPx + 1;
  if (i >= layer.coverage.size()) return nearest;
  for (int dy = -kLanczosReachPx; dy <= kLanczosReachPx; ++dy)
    for (int dx = -kLanczosReachPx; dx <= kLanczosReachPx; ++dx)
      if (layer.coverage[i].at(x + dx, y + dy) > 0)
        nearest = std::min(nearest, std::max(std::abs(dx), std::abs(dy)));
  return nearest;
}

// The changed pixels. One where several intruders are searched is of those that cover a pixel
// nearest to it.
std::vector<composite::Visible> changed(const image::Picture& before,
                                        const image::Picture& after,
                                        const image::Layer& layer,
                                        const setup::Moment& moment) {
  std::vector<composite::Visible> visible(moment.search.size());
  std::vector<std::optional<PixelBox>> searched(moment.search.size());
  for (std::size_t i = 0; i < searched.size(); ++i)
    if (moment.search[i])
      searched[i] = intersection(wider(pixels_of(*moment.search[i]), kLanczosReachPx),
                                 {0, 0, after.width, after.height});
  const auto is_of = [&](std::size_t i, int x, int y) {
    for (std::size_t other = 0; other < searched.size(); ++other)
      if (other != i && searched[other] && searched[other]->contains(x, y) &&
          distance_px(layer, other, x, y) < distance_px(layer, i, x, y))
        return false;
    return true;
  };
  for (std::size_t i = 0; i < visible.size(); ++i) {
    if (!searched[i]) continue;
    for (int y = searched[i]->y; y < searched[i]->bottom(); ++y)
      for (int x = searched[i]->x; x < searched[i]->right(); ++x)
        if (differs(before, after, x, y) && is_of(i, x, y)) visible[i].add(x, y);
    if (i < layer.coverage.size()) composite::add_coverage(layer, i, visible[i]);
  }
  return visible;
}

int quantiser_of(double codec_step) {
  // H.264's quantiser step, in code values, at a QP of 0; it doubles with every 6.
  constexpr double kStepAtQp0 = 0.625;
  return static_cast<int>(std::clamp(std::lround(6 * std::log2(codec_step / kStepAtQp0)), 1L, 51L));
}

// How far beyond a window the last frame's samples are kept: what moves faster, in pixels a frame,
// finds this frame's background there. libx264 searches 16 px around its prediction.
constexpr int kKeptAroundPx = 32;

}  // namespace

FrameCoder::FrameCoder(double codec_step) : codec_(quantiser_of(codec_step)) {}

image::Picture FrameCoder::reference(const PixelBox& box,
                                     const image::Picture& now,
                                     image::Picture Part::*samples) const {
  image::Picture result = now.clone();
  for (const Part& past : past_)
    image::paste(result, past.*samples, past.box.x - box.x, past.box.y - box.y);
  return result;
}

composite::Coded FrameCoder::code(const PixelBox& box,
                                  const image::Picture& with_layer,
                                  const image::Picture& background) {
  windows_.push_back({box, background.clone(), {}});
  return {codec_.coded(with_layer, reference(box, background, &Part::painted)),
          codec_.coded(background, reference(box, background, &Part::background))};
}

void FrameCoder::finish_frame(const image::Picture& painted) {
  past_.clear();
  for (const Part& window : windows_) {
    const PixelBox box =
        *intersection(wider(window.box, kKeptAroundPx), {0, 0, painted.width, painted.height});
    image::Picture background = image::crop(painted, box);
    for (const Part& other : windows_)
      image::paste(background, other.background, other.box.x - box.x, other.box.y - box.y);
    past_.push_back({box, std::move(background), image::crop(painted, box)});
  }
  windows_.clear();
}

Painter::Painter(const scene::Scene& scene,
                 const setup::World& world,
                 Occluders occluders,
                 std::unique_ptr<backdrop::Backdrop> opened,
                 std::stop_token stop)
    : scene_(scene),
      world_(world),
      occluders_(std::move(occluders)),
      stop_(std::move(stop)),
      backdrop_(std::move(opened)) {
  check(!is_by_key(scene) || backdrop_ != nullptr, "the chroma-key method has its OpenGL");
}

bool Painter::is_in_order() const {
  return !is_by_key(scene_) && setup::has_codec(scene_.camera_model);
}

void Painter::compose(image::Picture& picture,
                      const setup::Moment& moment,
                      const Ambient& ambient,
                      Painted& painted) {
  if (is_by_key(scene_)) return compose_by_key(picture, moment, ambient, painted);
  if (is_in_order() && !coder_) coder_.emplace(*scene_.camera_model.codec_step);
  if (!painted.layer.empty()) {
    composite::MatteOptions options;
    options.sensor = setup::sensor_of(setup::camera_in_weather(scene_));
    options.seed = scene_.seed;
    options.frame = moment.frame;
    options.coder = coder_ ? &*coder_ : nullptr;
    painted.visible = composite::composite_matte(picture, painted.layer, options);
  }
  if (coder_) coder_->finish_frame(picture);
}

void Painter::compose_by_key(image::Picture& picture,
                             const setup::Moment& moment,
                             const Ambient& ambient,
                             Painted& painted) {
  const auto& pinhole = std::get<lens::Pinhole>(world_.lens.model());
  std::vector<backdrop::Instance> instances;
  for (std::size_t i = 0; i < world_.actors.size(); ++i) {
    if (!moment.search[i]) continue;
    instances.push_back({&world_.actors[i].type->aircraft->mesh,
                         moment.states[i]->world_from_body_rigid(),
                         world_.actors[i].turned_s(moment.time_s)});
  }
  if (instances.empty()) return;
  const shade::Light light{
      setup::to_sun_in_world(scene_.light), ambient.sun, ambient.sky(), ambient.ground};
  const image::Rgb8 virtual_image =
      backdrop_->render(pinhole, moment.sight.cam_from_world, light, instances);
  const image::Picture before = picture.clone();
  composite::composite_chroma_key(picture,
                                  virtual_image,
                                  moment.sight.frame_from_nominal,
                                  {.own_aircraft = occluders_.own_aircraft()});
  painted.visible = changed(before, picture, painted.layer, moment);
}

Painted Painter::draw(const image::Picture& background,
                      const setup::Moment& moment,
                      const Ambient& ambient) const {
  const Occluders::InFrame before = occluders_.in_frame(moment, background);
  Painted painted;
  painted.layer = render_layer(scene_, world_, moment, ambient, before.occlusion, stop_);
  painted.has_occluders = occluders_.has_others();
  painted.horizon_is_assumed = before.horizon_is_assumed;
  return painted;
}

Painted Painter::paint(image::Picture& picture,
                       const setup::Moment& moment,
                       const Ambient& ambient) {
  Painted painted = draw(picture, moment, ambient);
  compose(picture, moment, ambient, painted);
  return painted;
}

image::Layer render_layer(const scene::Scene& scene,
                          const setup::World& world,
                          const setup::Moment& moment,
                          const Ambient& ambient,
                          const composite::Occlusion& occlusion,
                          const std::stop_token& stop) {
  const render::View view{&world.lens,
                          moment.sight.cam_from_world.inverse(),
                          moment.sight.frame_from_nominal.inverse(),
                          world.lens.size().width,
                          world.lens.size().height,
                          moment.sight.shutter,
                          moment.sight.camera,
                          moment.sight.frame_from_nominal_per_s};
  const shade::Light light = light_on_intruders(scene, ambient);
  const scene::CameraModel camera = setup::camera_in_weather(scene);
  std::vector<render::Instance> instances;
  bool any = false;
  for (std::size_t i = 0; i < world.actors.size(); ++i) {
    const setup::Actor& actor = world.actors[i];
    render::Instance instance{
        actor.type->model.get(), {}, actor.turned_s(moment.time_s), moment.twists[i]};
    if (moment.states[i]) instance.world_from_body = moment.states[i]->world_from_body_rigid();
    any = any || moment.search[i].has_value();
    instances.push_back(instance);
  }
  const lens::ImageSize size = world.lens.size();
  const composite::Spots on_lens{moment.spots, moment.sight.shutter, size.width, size.height};
  const std::vector<image::Coverage> covers = composite::covers_of(on_lens);
  const bool has_spots = !composite::are_out_of_view(covers);
  if (!any && !has_spots) return {};
  image::Layer layer;
  if (any) {
    layer = render::render(
        view, light, instances, moment.search, {.quality = scene.render.quality, .stop = stop});
    composite::find_areas(layer, occlusion);
    if (has_spots) composite::hide_behind(layer, covers, occlusion);
    layer = through_air_and_lens(std::move(layer), camera, ambient, size);
    composite::hide(layer, occlusion);
  }
  if (!has_spots) return layer;
  return composite::with_spots(
      std::move(layer), world.actors.size(), on_lens, covers, margin_px(camera));
}

void check_method(const scene::Scene& scene, const lens::Lens& lens) {
  if (!is_by_key(scene)) return;
  if (!scene.lens_marks.empty())
    throw Error(std::string("composite.method chroma-key has no picture of what is on the lens; "
                            "expected method = \"matte\", or no ") +
                    enum_name(scene.lens_marks.front().kind),
                scene.lens_marks.front().where);
  if (!scene.occluders.empty())
    throw Error(
        "composite.method chroma-key has no [[occluder]]; expected method = \"matte\", or none",
        scene.occluders.front().where);
  if (!std::holds_alternative<lens::Pinhole>(lens.model()))
    throw Error(std::string("composite.method chroma-key draws with OpenGL, which has the pinhole "
                            "alone; the lens is ") +
                    lens.name() + "; expected model = \"pinhole\" or method = \"matte\"",
                scene.lens.where);
}

void check_codec(const scene::Scene& scene, const image::Colour& colour) {
  if (setup::has_codec(scene.camera_model) && !video::PatchCodec::can_code(colour))
    throw Error(
        "has 4:4:0 samples, which H.264 has no layout for; expected a clip in 4:2:0, 4:2:2 or "
        "4:4:4, or "
        "a scene without sensor.codec_step",
        {scene.background.video.string()});
}

std::unique_ptr<backdrop::Backdrop> open_backdrop(const scene::Scene& scene,
                                                  const lens::Lens& lens,
                                                  const backdrop::Options& options) {
  if (!is_by_key(scene)) return nullptr;
  check_method(scene, lens);
  return backdrop::open_backdrop(lens.size().width, lens.size().height, options);
}

std::optional<image::Mask> read_mask(const scene::Scene& scene, const lens::ImageSize& size) {
  if (!scene.background.mask) return std::nullopt;
  return video::read_mask(*scene.background.mask, size.width, size.height);
}

}  // namespace airtruth::insertion
