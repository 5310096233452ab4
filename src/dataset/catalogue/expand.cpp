// SPDX-License-Identifier: Apache-2.0
#include "dataset/catalogue/expand.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include <fmt/format.h>

#include "dataset/catalogue/encounter_rule.h"
#include "dataset/catalogue/meeting.h"
#include "foundation/base/error.h"
#include "scene/scene/camera_keys.h"
#include "sequence/setup/from_scene.h"

namespace airtruth::catalogue {
namespace {

// Frame rate that is assumed for a background of unknown rate.
constexpr double kAssumedRateHz = 30;
// Length until place() knows the video's.
constexpr std::int64_t kProvisionalFrames = 300;
// Range until place() derives it from the size.
constexpr double kProvisionalRangeM = 1000;

std::int64_t size_of(const Rule& rule) {
  if (const auto* product = std::get_if<Product>(&rule))
    return static_cast<std::int64_t>(product->backgrounds.size()) *
           static_cast<std::int64_t>(product->trajectories.size()) *
           static_cast<std::int64_t>(product->aircraft.size());
  if (const auto* drawn = std::get_if<Drawn>(&rule)) return drawn->count;
  return std::get<EncounterRule>(rule).count;
}

std::string filled(std::string pattern, std::string_view key, const std::string& value) {
  for (std::size_t at = pattern.find(key); at != std::string::npos;
       at = pattern.find(key, at + value.size()))
    pattern.replace(at, key.size(), value);
  return pattern;
}

// The frames of a sequence that neither its rule nor its trajectory states.
std::int64_t frames_of(const Background& background) {
  const auto* flight = std::get_if<synthetic::FlightOptions>(&background.source);
  return flight != nullptr ? flight->frame_count : 0;  // 0: to the video's end
}

scene::Intruder intruder_of(const Aircraft& aircraft, const Trajectory& path) {
  scene::Intruder intruder = path.flown;
  intruder.id = aircraft.name;
  intruder.aircraft = aircraft.aircraft;
  return intruder;
}

Item item_of(const Catalogue& catalogue, const Product& rule, std::int64_t index) {
  auto i = static_cast<std::size_t>(index);
  const Aircraft& aircraft = catalogue.aircraft[rule.aircraft[i % rule.aircraft.size()]];
  i /= rule.aircraft.size();
  const Trajectory& path = catalogue.trajectories[rule.trajectories[i % rule.trajectories.size()]];
  Item item;
  item.background = rule.backgrounds[i / rule.trajectories.size()];
  const Background& background = catalogue.backgrounds[item.background];
  item.name = filled(rule.name, "{background}", background.name);
  item.name = filled(item.name, "{trajectory}", path.name);
  item.name = filled(item.name, "{aircraft}", aircraft.name);
  item.frame_count = rule.frame_count   ? *rule.frame_count
                     : path.frame_count ? *path.frame_count
                                        : frames_of(background);
  item.scene = scene_over(catalogue, item.background);
  if (!is_chosen("negatives of " + rule.name, rule.negatives, catalogue.seed, index))
    item.scene.intruders = {intruder_of(aircraft, path)};
  return item;
}

// A drawn sun takes the place of the background's, which is then not measured.
void take_sun(const DrawnSequence& drawn, scene::Light& light) {
  light.sun_azimuth_deg = drawn.sun_azimuth_deg.value_or(light.sun_azimuth_deg);
  light.sun_elevation_deg = drawn.sun_elevation_deg.value_or(light.sun_elevation_deg);
  if (drawn.sun_azimuth_deg || drawn.sun_elevation_deg) light.sun_is_stated = true;
}

// A drawn visibility takes the place of the background's extinction, which is then not measured.
void take_weather(const DrawnSequence& drawn, scene::Scene& scene) {
  scene.weather = drawn.weather;
  if (!drawn.visibility_m) return;
  const double extinction = scene::extinction_per_km(*drawn.visibility_m);
  scene.camera_model.extinction_per_km = {extinction, extinction, extinction};
  std::erase(scene.camera_model.automatic, "air.extinction_per_km");
}

// An item of a numbered rule before anything is in its scene.
Item empty_item(const Catalogue& catalogue,
                const NumberedRule& rule,
                std::int64_t index,
                std::size_t background) {
  Item item;
  item.index = index;
  item.name = filled(rule.name, "{index}", fmt::format("{:06}", index));
  item.background = background;
  item.frame_count = rule.frame_count;
  item.scene = scene_over(catalogue, background);
  item.scene.name = item.name;
  return item;
}

// The random values of a rule of [[random]] for one sequence. Until place() knows the background,
// its paths are provisional and belong to a clip at kAssumedRateHz.
Item item_of(const Catalogue& catalogue,
             const Drawn& rule,
             std::int64_t index,
             DrawnSequence drawn) {
  Item item = empty_item(catalogue, rule, index, drawn.background);
  item.rule = &rule;
  item.drawn = std::move(drawn);
  take_sun(item.drawn, item.scene.light);
  take_weather(item.drawn, item.scene);
  const DrawnClip clip{rule.frame_count, kAssumedRateHz};
  for (std::size_t k = 0; k < item.drawn.encounters.size(); ++k) {
    const Encounter& encounter = item.drawn.encounters[k];
    scene::Intruder intruder{
        .id = rule.numbers_intruders ? fmt::format("intruder-{}", k + 1) : "intruder",
        .aircraft = encounter.aircraft,
        .speed_mps = encounter.speed_mps,
        .where = rule.where};
    lay_path(intruder, encounter, item.scene.camera, clip, kProvisionalRangeM);
    item.scene.intruders.push_back(std::move(intruder));
  }
  return item;
}

Item item_of(const Catalogue& catalogue, const Drawn& rule, std::int64_t index) {
  return item_of(catalogue, rule, index, draw(rule, catalogue.backgrounds, catalogue.seed, index));
}

Item item_of(const Catalogue& catalogue, const EncounterRule& rule, std::int64_t index) {
  Item item = empty_item(
      catalogue,
      rule,
      index,
      stratified_background(rule.backgrounds, catalogue.backgrounds, rule.seed, rule.count, index));
  item.encounter_rule = &rule;
  item.index_in_rule = index;
  return item;
}

// A clip must not outlast the tracks of its encounter. A sample of a stream shows a part of them,
// wherever that is over its background.
void check_length(const Item& item, const BackgroundFiles& files) {
  if (item.encounter_rule == nullptr || files.frame_rate_hz <= 0) return;
  DrawnClip clip{item.frame_count, files.frame_rate_hz};
  if (!item.first_frame && !files.times_s.empty())
    clip = clip_over(files, item.scene.background.first_frame, item.frame_count);
  const double clip_s = clip.duration_s();
  if (clip_s > item.encounter_rule->length_s)
    throw Error(
        fmt::format("{}: {} frames at {:.3g} a second are {:.1f} s; encounters are drawn for "
                    "{:.0f} s, expected 24 frames a second or more",
                    files.video.string(),
                    clip.frames,
                    static_cast<double>(clip.frames) / clip_s,
                    clip_s,
                    double(item.encounter_rule->length_s)),
        item.scene.background.where);
}

}  // namespace

scene::Scene scene_over(const Catalogue& catalogue, std::size_t place) {
  const Background& background = catalogue.backgrounds[place];
  scene::Scene scene;
  static_cast<scene::CameraTables&>(scene) = background;
  // A virtual flight is made with that sun.
  if (std::holds_alternative<synthetic::FlightOptions>(background.source))
    scene.light.sun_is_stated = true;
  static_cast<scene::OutputTables&>(scene) = catalogue;
  scene.seed = catalogue.seed;
  scene.file = catalogue.file;
  scene.background.name = background.name;
  scene.background.frame_rate_hz = background.frame_rate_hz;
  scene.background.where = background.where;
  return scene;
}

Item stream_item(const Catalogue& catalogue,
                 const Drawn& rule,
                 const StreamPlace& place,
                 std::uint64_t seed) {
  DrawnSequence drawn = draw(rule, catalogue.backgrounds, seed, place.index);
  drawn.background = place.background;
  Item item = item_of(catalogue, rule, place.index, std::move(drawn));
  item.first_frame = place.first_frame;
  item.distractors = draw_distractors(catalogue.distractors, seed, place.index);
  return item;
}

Item stream_item(const Catalogue& catalogue,
                 const EncounterRule& rule,
                 const StreamPlace& place,
                 std::uint64_t seed) {
  Item item = empty_item(catalogue, rule, place.index, place.background);
  item.encounter_rule = &rule;
  item.index_in_rule = place.index % rule.count;
  item.first_frame = place.first_frame;
  item.distractors = draw_distractors(catalogue.distractors, seed, place.index);
  return item;
}

Expansion::Expansion(const Catalogue& catalogue) : catalogue_(catalogue) {
  for (const Rule& rule : catalogue.rules) {
    first_.push_back(size_);
    size_ += size_of(rule);
    if (size_ > kMostSequences)
      throw Error(fmt::format("makes more than {} sequences; expected fewer: lower counts, or "
                              "several catalogues",
                              kMostSequences),
                  {catalogue.file.string()});
  }
}

Item Expansion::at(std::int64_t index) const {
  check(index >= 0 && index < size_, "a sequence's number is within its catalogue");
  const auto after = std::upper_bound(first_.begin(), first_.end(), index);
  const auto rule = static_cast<std::size_t>(after - first_.begin()) - 1;
  Item item =
      std::visit([&](const auto& r) { return item_of(catalogue_, r, index - first_[rule]); },
                 catalogue_.rules[rule]);
  item.index = index;
  item.where = std::visit([](const auto& r) { return r.where; }, catalogue_.rules[rule]);
  item.scene.name = item.name;
  item.distractors = draw_distractors(catalogue_.distractors, catalogue_.seed, index);
  const std::int64_t frames = item.frame_count > 0 ? item.frame_count : kProvisionalFrames;
  lay_distractors(item.scene, item.distractors, {frames, kAssumedRateHz}, nullptr);
  return item;
}

namespace {

// The first frame of a clip at a random position of its background at which it fits.
std::int64_t random_first_frame(const Item& item,
                                std::int64_t first_frame,
                                const BackgroundFiles& files) {
  if (files.frames <= 0)
    throw Error("start is random, but " + files.video.string() +
                    " does not state how many frames it has; expected start = \"first\", or a "
                    "file that does",
                item.rule->where);
  const std::int64_t places =
      std::max<std::int64_t>(1, files.frames - first_frame - item.frame_count + 1);
  const auto place = static_cast<std::int64_t>(item.drawn.start_share * double(places));
  return first_frame + std::min(place, places - 1);
}

}  // namespace

DrawnClip clip_over(const BackgroundFiles& files, std::int64_t first_frame, std::int64_t frames) {
  const std::int64_t left = files.frames - first_frame;
  if (left > 0) frames = frames > 0 ? std::min(frames, left) : left;
  DrawnClip clip{frames,
                 files.frame_rate_hz > 0 ? files.frame_rate_hz : kAssumedRateHz,
                 {files.width, files.height}};
  if (first_frame < std::ssize(files.times_s))
    clip.times_s = std::span(files.times_s).subspan(static_cast<std::size_t>(first_frame));
  return clip;
}

namespace {

// The clip of an item from a frame of its background on. A sample of a stream shows a part of a
// passage, wherever that is over its background.
DrawnClip drawn_clip(const Item& item, std::int64_t first_frame, const BackgroundFiles& files) {
  DrawnClip clip = clip_over(files, first_frame, item.frame_count);
  if (!item.first_frame || (item.rule != nullptr && !item.rule->approach)) return clip;
  clip.frames = item.frame_count;
  clip.times_s = {};
  return clip;
}

}  // namespace

Draws draw_in_view(Item& item, const Catalogue& catalogue, const BackgroundFiles& files) {
  if (files.camera) item.scene.camera = *files.camera;
  setup::take_pixel_shape(item.scene.lens, {files.width, files.height}, files.pixel_aspect);
  if (item.encounter_rule == nullptr) return {};
  check_length(item, files);
  const DrawnClip clip =
      drawn_clip(item, catalogue.backgrounds[item.background].first_frame, files);
  const Views views{setup::lens_of(item.scene.lens, clip.size), clip.frames, clip.frame_rate_hz};
  std::vector<scene::Intruder> distractors = std::exchange(item.scene.intruders, {});
  const Draws draws = add_encounter(item.scene, *item.encounter_rule, item.index_in_rule, views);
  std::move(distractors.begin(), distractors.end(), std::back_inserter(item.scene.intruders));
  return draws;
}

void place(Item& item,
           const Catalogue& catalogue,
           const BackgroundFiles& files,
           setup::SharedInputs* shared) {
  const Background& background = catalogue.backgrounds[item.background];
  scene::Background& placed = item.scene.background;
  placed.video = files.video;
  placed.mask = files.mask;
  placed.first_frame = item.first_frame.value_or(background.first_frame);
  if (item.frame_count > 0) placed.frame_count = item.frame_count;
  draw_in_view(item, catalogue, files);
  if (!item.first_frame && item.has_random_start())
    placed.first_frame = random_first_frame(item, background.first_frame, files);
  DrawnClip clip = drawn_clip(item, placed.first_frame, files);
  const std::int64_t left = files.frames - placed.first_frame;
  if (background.frame_count && left > 0)
    placed.frame_count = std::min(placed.frame_count.value_or(left), left);
  if (clip.frames == 0) clip.frames = kProvisionalFrames;
  if (item.rule != nullptr)
    for (std::size_t k = 0; k < item.drawn.encounters.size(); ++k)
      meet(item.scene.intruders[k], item.scene, item.drawn.encounters[k], clip, shared);
  lay_distractors(item.scene, item.distractors, clip, shared);
}

}  // namespace airtruth::catalogue
