// SPDX-License-Identifier: Apache-2.0
#include "studio/session/gallery.h"

#include <algorithm>
#include <array>
#include <vector>

#include "aircraft/fleet/fleet.h"
#include "aircraft/fleet/flight_limits.h"
#include "aircraft/fleet/scale.h"
#include "foundation/base/names.h"
#include "scene/scene/distractor.h"
#include "sequence/demo/aircraft_sheet.h"
#include "sequence/setup/from_scene.h"
#include "sequence/setup/world.h"
#include "studio/session/answers.h"

namespace airtruth::session {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostPictures = 2000;  // of some 5 kB

// In the air; what is on the lens has no shape of its own.
constexpr std::array kKinds = {scene::DistractorKind::kBird,
                               scene::DistractorKind::kMultirotor,
                               scene::DistractorKind::kBalloon};

// "airliner"; empty where the type has no class.
std::string class_of(const std::string& name) {
  const fleet::FlightLimits* limits = fleet::flight_limits(name);
  return limits == nullptr ? "" : std::string(limits->name);
}

Json group_of(const std::string& type, const std::vector<std::string>& liveries) {
  const fleet::PublishedSize* size = fleet::published_size(liveries.front());
  const bool is_known = size != nullptr && size->is_known();
  return {{"name", type},
          {"type", size != nullptr ? size->type : ""},
          {"class", class_of(liveries.front())},
          {"length_m", is_known ? Json(size->length_m) : Json()},
          {"span_m", is_known ? Json(size->span_m) : Json()},
          {"liveries", liveries}};
}

scene::Intruder distractor_of(scene::DistractorKind kind) {
  scene::Intruder intruder;
  intruder.aircraft = enum_name(kind);
  intruder.distractor = scene::usual_distractor(kind, scene::usual_size_m(kind));
  return intruder;
}

}  // namespace

Json Gallery::groups(const std::string& word) {
  std::vector<std::pair<std::string, std::vector<std::string>>> types;
  for (const fleet::Entry& entry : fleet::list_aircraft()) {
    const std::string type = entry.name.substr(0, entry.name.find('/'));
    if (types.empty() || types.back().first != type) types.push_back({type, {}});
    types.back().second.push_back(entry.name);
  }
  Json groups = Json::array();
  for (const auto& [type, all] : types) {
    const fleet::PublishedSize* size = fleet::published_size(all.front());
    const bool is_whole = contains_ignoring_case(type, word) ||
                          contains_ignoring_case(class_of(all.front()), word) ||
                          (size != nullptr && contains_ignoring_case(size->type, word));
    std::vector<std::string> liveries;
    for (const std::string& name : all)
      if (is_whole || contains_ignoring_case(name, word)) liveries.push_back(name);
    if (!liveries.empty()) groups.push_back(group_of(type, liveries));
  }
  return {{"groups", groups}};
}

std::optional<std::string> Gallery::picture(const std::string& name, const std::stop_token& stop) {
  if (const auto found = pictures_.find(name); found != pictures_.end()) return found->second;
  fleet::Aircraft aircraft;
  const auto kind = std::ranges::find_if(
      kKinds, [&](scene::DistractorKind one) { return enum_name(one) == name; });
  if (kind != kKinds.end()) {
    aircraft =
        setup::aircraft_of(distractor_of(*kind), setup::camera_path(scene::Camera{}), {}, stop);
  } else {
    const std::vector<fleet::Entry> all = fleet::list_aircraft();
    if (std::ranges::find(all, name, &fleet::Entry::name) == all.end()) return std::nullopt;
    model::LoadOptions options;
    options.stop = stop;
    aircraft = fleet::load_aircraft(name, options, {});
  }
  if (pictures_.size() >= kMostPictures) pictures_.clear();
  return pictures_[name] = jpeg_of(demo::aircraft_tile(aircraft));
}

}  // namespace airtruth::session
