// SPDX-License-Identifier: Apache-2.0
#include <airtruth/encounters.h>

#include "encounter/sets/sets.h"
#include "encounter/track/track.h"
#include "foundation/geometry/transform.h"

namespace airtruth {
namespace {

void add_rows(SampledEncounters& result, const track::Track& track, std::int64_t aircraft) {
  const std::vector<Vector3> velocities = track::velocities_of(track);
  for (std::size_t i = 0; i < track.size(); ++i) {
    result.encounter.push_back(std::ssize(result.weights));
    result.aircraft.push_back(aircraft);
    result.time_s.push_back(track.times_s[i]);
    result.position_ned_m.push_back(numbers_of(track.positions_ned_m[i]));
    result.velocity_ned_mps.push_back(numbers_of(velocities[i]));
  }
}

}  // namespace

SampledEncounters sample_encounters(const std::string& model, const EncounterOptions& options) {
  const sets::SampleRequest request{options, model};
  const sets::SampledSet set = sets::sampled_set(request);
  const sets::DrawnSet drawn = sets::draw_set(set.draw, options);
  SampledEncounters result;
  for (const track::Track& track : drawn.encounters.front().aircraft)
    result.aircraft_names.push_back(track.name);
  for (const track::Encounter& encounter : drawn.encounters) {
    result.weights.push_back(encounter.weight);
    for (std::size_t k = 0; k < encounter.aircraft.size(); ++k)
      add_rows(result, encounter.aircraft[k], static_cast<std::int64_t>(k));
  }
  result.share = set.share;
  result.draws = static_cast<std::int64_t>(drawn.summary.draws);
  result.effective_count = drawn.summary.effective_count();
  return result;
}

}  // namespace airtruth
