// SPDX-License-Identifier: Apache-2.0
#include "dataset/build/check.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "aircraft/fleet/fleet.h"
#include "dataset/build/backgrounds.h"
#include "dataset/catalogue/expand.h"
#include "foundation/base/error.h"
#include "sequence/pipeline/resolved_scene.h"

namespace airtruth::build {
namespace {

void check_aircraft(const catalogue::Aircraft& aircraft) {
  try {
    fleet::aircraft_file(aircraft.aircraft);
  } catch (const Error& error) {
    throw Error(error.message(), aircraft.where);
  }
}

void check_video(const catalogue::Background& background) {
  const auto* video = std::get_if<fs::path>(&background.source);
  // The reader checks a pattern of numbered images.
  if (video != nullptr && video->string().find('%') == std::string::npos && !fs::exists(*video))
    throw Error("the video of background '" + background.name + "', " + video->string() +
                    ", does not exist",
                background.where);
}

// Checks mask, lens, camera file and path of a background. Each sequence decides how much of the
// clip it uses, and the camera's path must cover only that part.
void check_background(const catalogue::Catalogue& catalogue, std::size_t place) {
  const catalogue::Background& background = catalogue.backgrounds[place];
  check_video(background);
  scene::Scene scene = catalogue::scene_over(catalogue, place);
  if (std::holds_alternative<fs::path>(background.source)) scene.background.mask = background.mask;
  video::StreamInfo info = stream_of(background);
  info.frame_count_estimate = 0;  // unknown
  pipeline::check_scene(scene, info);
}

// The names of one rule differ by construction, but names of two rules may coincide. Hashes are
// compared because a million names must cost no more than eight bytes each.
void check_names(const catalogue::Catalogue& catalogue) {
  if (catalogue.rules.size() < 2) return;
  const catalogue::Expansion expansion(catalogue);
  std::vector<std::size_t> hashes;
  hashes.reserve(static_cast<std::size_t>(expansion.size()));
  const std::hash<std::string> hash;
  for (std::int64_t i = 0; i < expansion.size(); ++i) hashes.push_back(hash(expansion.at(i).name));
  std::vector<std::size_t> sorted = hashes;
  std::sort(sorted.begin(), sorted.end());
  const auto twin = std::adjacent_find(sorted.begin(), sorted.end());
  if (twin == sorted.end()) return;
  const auto first = std::find(hashes.begin(), hashes.end(), *twin);
  const auto second = std::find(first + 1, hashes.end(), *twin);
  const std::string name = expansion.at(first - hashes.begin()).name;
  if (expansion.at(second - hashes.begin()).name == name)
    throw Error("two sequences are named '" + name + "'", {catalogue.file.string()});
}

}  // namespace

void check_sources(const catalogue::Catalogue& catalogue) {
  for (const catalogue::Aircraft& aircraft : catalogue.aircraft) check_aircraft(aircraft);
  for (std::size_t i = 0; i < catalogue.backgrounds.size(); ++i) check_background(catalogue, i);
  check_names(catalogue);
}

catalogue::Catalogue with_videos(catalogue::Catalogue catalogue,
                                 const std::map<std::string, fs::path>& videos) {
  for (const auto& [name, video] : videos) {
    const auto replaced = std::find_if(
        catalogue.backgrounds.begin(),
        catalogue.backgrounds.end(),
        [&, n = name](const catalogue::Background& background) { return background.name == n; });
    if (replaced == catalogue.backgrounds.end())
      throw Error("there is no background '" + name + "' to replace", {catalogue.file.string()});
    replaced->source = video;
    replaced->mask.reset();
    std::erase_if(replaced->occluders, [](const scene::Occluder& one) { return one.mask; });
  }
  return catalogue;
}

}  // namespace airtruth::build
