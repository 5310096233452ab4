// SPDX-License-Identifier: Apache-2.0
#include "encounter/tracks_file/track_builder.h"

#include <utility>

#include <fmt/format.h>

namespace airtruth::tracks_file {

void TrackBuilder::add(const std::string& name,
                       double time_s,
                       const Vector3& position_ned_m,
                       const Vector3* velocity_ned_mps,
                       const Where& where) {
  std::vector<track::Track>& aircraft = encounter_.aircraft;
  if (last_ >= aircraft.size() || aircraft[last_].name != name) {
    const auto [place, is_new] = places_.try_emplace(name, aircraft.size());
    if (is_new && aircraft.size() == kMaxAircraft)
      throw Error(fmt::format("'{}' is aircraft {} of the encounter; expected up to {}",
                              name,
                              aircraft.size() + 1,
                              kMaxAircraft),
                  where);
    if (is_new) aircraft.push_back({name, {}, {}, {}});
    last_ = place->second;
  }
  track::Track& track = aircraft[last_];
  if (!track.times_s.empty() && !(time_s > track.times_s.back()))
    throw Error(fmt::format("the time of '{}' is {} s after {} s; expected times that increase",
                            name,
                            time_s,
                            track.times_s.back()),
                where);
  track.times_s.push_back(time_s);
  track.positions_ned_m.push_back(position_ned_m);
  if (velocity_ned_mps != nullptr) track.velocities_ned_mps.push_back(*velocity_ned_mps);
}

track::Encounter TrackBuilder::take() {
  places_.clear();
  last_ = 0;
  return std::exchange(encounter_, track::Encounter{});
}

}  // namespace airtruth::tracks_file
