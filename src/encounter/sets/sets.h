// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <airtruth/encounters.h>

#include "encounter/encounter_model/sampler.h"
#include "encounter/pairing/pair.h"
#include "encounter/track/track.h"

// Sets of encounters: as a user asks for them, drawn on all cores, and written to one file.
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

// The own track, likewise, and an intruder of the stratified geometry that flies as long, drawn as
// geometric_passage() does. Throws Error where that is longer than kMaxDuration_s.
DrawEncounter geometric_pairs(const pairing::GeometricSampler& sampler, track::Track own);

// In place of a model: steady flight from stated ranges.
inline constexpr const char* kGeometric = "geometric";

struct SampleRequest : EncounterOptions {
  std::string model;  // an encounter model of MIT-LL, or kGeometric
  // What the user calls a member of this struct; for messages.
  std::function<std::string(const std::string& member)> name_of = [](const std::string& member) {
    return member;
  };

  bool is_geometric() const { return model == kGeometric; }
};

struct SampledSet {
  DrawEncounter draw;
  // Share of the model's traffic that is in the cut, 0..1.
  double share = 1;
};

// Throws Error for files that cannot be read, for what is out of range, and for what is stated and
// has no effect, so that nobody relies on it.
SampledSet sampled_set(const SampleRequest& request);

struct SetSummary {
  std::uint64_t encounters = 0;
  // Tracks drawn in all, those that could not be used too.
  std::uint64_t draws = 0;
  double weight_sum = 0;
  double weight_squares = 0;

  // How many encounters of equal weight tell as much (Kish 1965): the square of the sum over the
  // sum of the squares.
  double effective_count() const { return weight_sum * weight_sum / weight_squares; }
};

// Draws encounters 0 to count - 1 and writes them in order; of the options count, jobs, progress
// and stop matter. No more than a few thousand encounters stand in memory at a time, except in a
// format that holds a single encounter. Throws Error where one cannot be drawn, the format cannot
// hold them, or the disk refuses the file, and Interrupted after a stop; then no file is left.
SetSummary write_set(const std::filesystem::path& file,
                     const DrawEncounter& draw,
                     const EncounterOptions& options);

// The same encounters in memory, at most kMaxInMemory.
constexpr std::int64_t kMaxInMemory = 1'000'000;
struct DrawnSet {
  std::vector<track::Encounter> encounters;
  SetSummary summary;
};
DrawnSet draw_set(const DrawEncounter& draw, const EncounterOptions& options);

}  // namespace airtruth::sets
