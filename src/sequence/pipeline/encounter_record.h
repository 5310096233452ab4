// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "encounter/passage/passage.h"
#include "foundation/json/json_object.h"
#include "labels/annotation/truth.h"
#include "sequence/setup/world.h"

// The encounters of a whole sequence, as sequence.json records them (docs/formats/output.md).
namespace airtruth::pipeline {

// The first frame in which an intruder is visible.
struct FirstSeen {
  std::int64_t frame = 0;
  double time_s = 0;
  double range_m = 0;
  Box exact_box_px;
};
std::optional<FirstSeen> seen_in(const annotation::Frame& frame,
                                 const annotation::Intruder& intruder);

struct NamedInterval {
  std::string volume;
  separation::Interval time;
};

struct EncounterRecord {
  std::string id;
  // From the first frame to the lookahead after the last one; empty for an intruder that is not in
  // the world then, for one that still comes nearer when a path, or that time, ends, and for one
  // that keeps its distance (passage::Approach::is_kept).
  std::optional<passage::Approach> closest;
  // Of the states where they are nearest in that time.
  std::optional<passage::Meeting> meeting;
  std::optional<passage::VerticalMotion> vertical_motion;
  // Where they are nearest; empty for one that is never seen.
  std::optional<passage::AgainstHorizon> horizon;
  std::optional<FirstSeen> first_seen;
  std::optional<passage::AgainstHorizon> horizon_when_first_seen;
  // In the order of the world's volumes; over the same time as `closest`.
  std::vector<NamedInterval> violations;
};

// Of the aircraft alone; a distractor has no encounter. `first_seen`: by actor. `last_s`: the time
// of the last frame.
std::vector<EncounterRecord> encounter_records(
    const setup::World& world,
    const std::vector<std::optional<FirstSeen>>& first_seen,
    double last_s);

nlohmann::ordered_json json_of(const std::vector<EncounterRecord>& records);

// The records that a sequence.json holds. Of the exact box of the first frame that shows an
// intruder only the size is recorded. Throws Error where one is not as docs/formats/output.md
// describes it.
std::vector<EncounterRecord> read_encounter_records(const JsonObject& sequence);

}  // namespace airtruth::pipeline
