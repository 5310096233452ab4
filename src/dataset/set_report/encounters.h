// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "sequence/replay/finished.h"

// What the data card and the report page say of encounters. Imported clips have none.
namespace airtruth::set_report {

// When an intruder is nearest; empty where the sequence has no record of it.
std::optional<double> closest_s(const replay::Finished& finished, const std::string& id);

// North, east, down of both aircraft at the closest approach of an encounter: between the two
// frames around it, in proportion to time. Empty where it comes after the last frame.
struct ClosestPlaces {
  std::array<double, 3> own_ned_m{};
  std::array<double, 3> intruder_ned_m{};
};
std::optional<ClosestPlaces> closest_places(const std::vector<annotation::Frame>& frames,
                                            const pipeline::EncounterRecord& record);

// One sentence for each kind of fact: how many encounters of each class, how close they come, when
// they are first seen and which volumes they violate. `volumes`: the names of those that the truth
// asks for. Empty without encounters.
std::string encounters_text(const std::vector<pipeline::EncounterRecord>& records,
                            const std::vector<std::string>& volumes);

}  // namespace airtruth::set_report
