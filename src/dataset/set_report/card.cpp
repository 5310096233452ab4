// SPDX-License-Identifier: Apache-2.0
#include "dataset/set_report/card.h"

#include <algorithm>
#include <functional>
#include <map>
#include <string>
#include <string_view>

#include <airtruth/version.h>
#include <fmt/format.h>

#include "aircraft/wrapper/reader.h"
#include "dataset/catalogue/folder.h"
#include "dataset/set_report/encounters.h"
#include "scene/scene/camera_keys.h"

namespace airtruth::set_report {
namespace {

using scene::Scene;
using Scenes = std::vector<Scene>;

std::size_t count_of(const Scenes& scenes, const std::function<bool(const Scene&)>& has) {
  return static_cast<std::size_t>(std::count_if(scenes.begin(), scenes.end(), has));
}

// The effects of the camera and the air on an intruder, in the order of the scene's keys.
std::vector<std::string_view> all_effects() {
  std::vector<std::string_view> effects;
  for (const scene::CameraKey& key : scene::kCameraModelKeys)
    if (!key.effect.empty() &&
        std::find(effects.begin(), effects.end(), key.effect) == effects.end())
      effects.push_back(key.effect);
  return effects;
}

bool has_effect(const scene::CameraModel& model, std::string_view effect) {
  return std::ranges::any_of(scene::kCameraModelKeys, [&](const scene::CameraKey& key) {
    return key.effect == effect && scene::is_above_zero(model, key);
  });
}

std::string share_of(std::size_t count, std::size_t all) {
  return count == all ? "" : fmt::format(" (in {} of {} sequences)", count, all);
}

std::string background_text(const catalogue::Background& background) {
  const auto* flight = std::get_if<synthetic::FlightOptions>(&background.source);
  if (flight == nullptr)
    return std::get<std::filesystem::path>(background.source).filename().string() +
           ": a video; its licence is its owner's to state";
  return fmt::format(
      "virtual flight, seed {}, {} frames, {}x{}; drawn by airtruth, not filmed, and free of "
      "others' rights",
      flight->seed,
      flight->frame_count,
      flight->width,
      flight->height);
}

void add_catalogue(const catalogue::Folder& folder, Card& card) {
  const catalogue::Catalogue catalogue = catalogue::read_catalogue(folder.catalogue());
  card.emplace_back("name", catalogue.name);
  card.emplace_back("seed", fmt::format("{}", catalogue.seed));
  card.emplace_back("complete",
                    std::filesystem::exists(folder.record()) ? "yes" : "no: sequences are missing");
  for (const catalogue::Background& background : catalogue.backgrounds)
    card.emplace_back("background " + background.name, background_text(background));
}

std::string rendering_text(const Scenes& scenes) {
  std::vector<std::string> kinds;
  for (const Scene& s : scenes) {
    const std::string kind = fmt::format("quality {}, {}, {}",
                                         s.render.quality,
                                         enum_name(s.composite.method),
                                         enum_name(s.output.video));
    if (std::find(kinds.begin(), kinds.end(), kind) == kinds.end()) kinds.push_back(kind);
  }
  return fmt::format("{}", fmt::join(kinds, "; "));
}

std::string aircraft_text(const Scenes& scenes) {
  bool any_of_flightgear = false, any_file = false;
  for (const Scene& s : scenes)
    for (const scene::Intruder& intruder : s.intruders)
      if (is_aircraft(intruder))
        (wrapper::is_model_file(intruder.aircraft) ? any_file : any_of_flightgear) = true;
  std::vector<std::string> parts;
  if (any_of_flightgear)
    parts.emplace_back(
        "models of FlightGear's AI traffic (Debian package flightgear-data-ai, GPL-2+): pictures "
        "of "
        "them in this set derive from those models");
  if (any_file) parts.emplace_back("model files, whose licence is their owners' to state");
  return parts.empty() ? "none" : fmt::format("{}", fmt::join(parts, "; "));
}

// The sequences without an aircraft, and what else is in the pictures.
std::string negatives_text(const Scenes& scenes) {
  std::map<std::string, std::size_t> counts;
  for (const Scene& s : scenes) {
    for (const scene::Intruder& intruder : s.intruders)
      if (!is_aircraft(intruder)) ++counts[enum_name(intruder.distractor->kind)];
    for (const scene::LensMark& mark : s.lens_marks) ++counts[enum_name(mark.kind)];
  }
  const std::size_t negatives = count_of(scenes, [](const Scene& s) {
    return std::none_of(s.intruders.begin(), s.intruders.end(), scene::is_aircraft);
  });
  std::string text = fmt::format("{} of {} sequences have no aircraft", negatives, scenes.size());
  for (const auto& [kind, count] : counts)
    text += fmt::format(
        "{} {} {}", &kind == &counts.begin()->first ? "; distractors:" : ",", count, kind);
  return text;
}

std::string labels_text(const std::vector<Portrait>& portraits, const Scenes& scenes) {
  std::int64_t frames = 0, without = 0, visible = 0, covered = 0;
  for (const Portrait& portrait : portraits) {
    if (!portrait.scene) continue;
    frames += portrait.facts.frames;
    without += portrait.without_box;
    visible += portrait.frames_by_state[0];
    covered += portrait.covered_boxes;
  }
  const std::size_t with_masks = count_of(scenes, [](const Scene& s) { return s.output.masks; });
  return fmt::format(
      "computed, not drawn by hand: exact boxes from the projected shape, covered boxes from the "
      "pixels that the aircraft covers ({} for {} sightings), visible boxes from the pixels that "
      "changed. In view by geometry and without a box: {} of {} frames. Masks of pixels: {}",
      covered,
      visible,
      without,
      frames,
      with_masks == 0 ? "none" : fmt::format("in {} of {} sequences", with_masks, scenes.size()));
}

void add_encounters(const std::vector<Portrait>& portraits, const Scenes& scenes, Card& card) {
  std::vector<pipeline::EncounterRecord> records;
  for (const Portrait& portrait : portraits)
    records.insert(records.end(), portrait.encounters.begin(), portrait.encounters.end());
  std::vector<std::string> volumes;
  const auto add = [&](const std::string& name) {
    if (std::find(volumes.begin(), volumes.end(), name) == volumes.end()) volumes.push_back(name);
  };
  for (const Scene& s : scenes) {
    for (const std::string& name : s.truth.volumes) add(name);
    for (const scene::TruthVolume& volume : s.truth.own_volumes) add(volume.name);
  }
  const std::string text = encounters_text(records, volumes);
  if (!text.empty()) card.emplace_back("encounters", text);
}

}  // namespace

std::string camera_sentence(const std::vector<Scene>& scenes) {
  std::vector<std::string> with, without;
  for (const std::string_view effect : all_effects()) {
    const std::size_t count =
        count_of(scenes, [&](const Scene& s) { return has_effect(s.camera_model, effect); });
    if (count > 0)
      with.push_back(std::string(effect) + share_of(count, scenes.size()));
    else
      without.emplace_back(effect);
  }
  std::string text = with.empty() ? "none of what a camera and the air do"
                                  : fmt::format("{}", fmt::join(with, ", "));
  if (!without.empty()) text += fmt::format(". Not on the intruder: {}", fmt::join(without, ", "));
  return text;
}

std::string motion_sentence(const std::vector<Scene>& scenes) {
  std::vector<std::string> parts;
  const auto add = [&](scene::MotionModel model, const std::string& words) {
    const std::size_t n = count_of(scenes, [&](const Scene& s) { return s.motion.model == model; });
    if (n > 0) parts.push_back(words + share_of(n, scenes.size()));
  };
  add(scene::MotionModel::kRotation,
      "a rotation through the lens, measured in the video, exact for what is far");
  add(scene::MotionModel::kHomography,
      "a homography, measured in the video, exact for what is far through a pinhole");
  add(scene::MotionModel::kNone,
      "none is looked for: the camera moves along its stated path alone");
  return fmt::format("{}", fmt::join(parts, "; "));
}

Card card_of(const std::filesystem::path& set, const std::vector<Portrait>& portraits) {
  Card card = {{"made by", std::string("airtruth ") + kVersion}};
  const catalogue::Folder folder{set};
  if (std::filesystem::exists(folder.catalogue())) add_catalogue(folder, card);
  std::int64_t frames = 0;
  Scenes scenes;
  for (const Portrait& portrait : portraits) {
    frames += portrait.facts.frames;
    if (portrait.scene) scenes.push_back(*portrait.scene);
  }
  card.emplace_back("frames", fmt::format("{}", frames));
  if (scenes.size() < portraits.size())
    card.emplace_back(
        "imported",
        fmt::format("{} of {} sequences were labelled elsewhere; of how they were made "
                    "nothing is known here",
                    portraits.size() - scenes.size(),
                    portraits.size()));
  if (scenes.empty()) return card;
  card.emplace_back("rendering", rendering_text(scenes));
  card.emplace_back("aircraft", aircraft_text(scenes));
  card.emplace_back("negatives and distractors", negatives_text(scenes));
  card.emplace_back("labels", labels_text(portraits, scenes));
  add_encounters(portraits, scenes, card);
  card.emplace_back("on the intruder's light", camera_sentence(scenes));
  card.emplace_back("the camera's motion", motion_sentence(scenes));
  return card;
}

}  // namespace airtruth::set_report
