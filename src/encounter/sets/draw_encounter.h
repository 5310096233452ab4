// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>

#include "encounter/encounter_model/sampler.h"
#include "encounter/pairing/geometric.h"
#include "encounter/pairing/pair.h"
#include "encounter/track/track.h"

// The encounters of a set, one by one.
namespace airtruth::sets {

struct DrawnEncounter {
  track::Encounter encounter;
  // How many tracks were drawn for it.
  int draws = 1;
};

// Gives encounter `index` of a set; it depends on the index alone, and any thread may ask for any.
// It throws Error where the encounter cannot be drawn.
using DrawEncounter = std::function<DrawnEncounter(std::uint64_t index)>;

// Tracks of a model by themselves: encounters of one aircraft.
DrawEncounter model_tracks(std::shared_ptr<const encounter_model::Sampler> sampler);

// The own track, with a sample in each second, and an intruder from the model that begins at the
// same time and is paired with it. The time of the closest approach is one of the own track's.
// Throws Error where the own track does not contain it.
DrawEncounter model_pairs(std::shared_ptr<const encounter_model::Sampler> sampler,
                          track::Track own,
                          const pairing::PairingOptions& options,
                          std::uint64_t seed);

// The own track, likewise, and an intruder of the stratified geometry that flies as long. Throws
// Error where that is longer than kMaxDuration_s.
DrawEncounter geometric_pairs(const pairing::GeometricSampler& sampler, track::Track own);

}  // namespace airtruth::sets
