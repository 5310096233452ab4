// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <stop_token>
#include <string>
#include <vector>

#include "dataset/catalogue/expand.h"

namespace airtruth::build {

// Summary of what a catalogue would make. Nothing is rendered, and no more of a video is
// decoded than its first frame in use.
struct Plan {
  std::int64_t sequences = 0;
  std::int64_t negatives = 0;  // sequences without an aircraft
  // Aircraft in all sequences.
  std::int64_t intruders = 0;
  // What is no aircraft, by kind: "bird" -> 12.
  std::map<std::string, std::int64_t> distractors;
  // Total over the sequences whose length is known.
  std::int64_t frames = 0;
  // Sequences that run to the end of a video of unknown length.
  std::int64_t open_ended = 0;
  // Number of intruders by type and by livery: "738" -> "738/738-Ryanair" -> 12. A model file is
  // its own type.
  std::map<std::string, std::map<std::string, std::int64_t>> aircraft;
  std::vector<double> sizes_px;  // that were drawn
  std::vector<double> ranges_m;  // that were drawn
  // Intruders whose path is beyond the limits of their class.
  std::int64_t not_flyable = 0;
  // Descriptions of the first kMaxNamed of these: "NAME: why".
  std::vector<std::string> not_flyable_words;
  // A number that a message can name: a choice.
  static constexpr std::size_t kMaxNamed = 5;
  // Draws of [[encounter_model]] until an intruder was in view, and intruders that no draw brought
  // there.
  std::int64_t draws = 0;
  std::int64_t never_in_view = 0;
  // Estimated time on one core, in seconds, including calibration_s.
  double core_s = 0;
  // Estimated time for measuring cameras, in seconds; each background counts once.
  double calibration_s = 0;
  double bytes = 0;
};

// Calls `each` for every sequence in order. Throws Error, as video::Reader does, for a background
// whose video cannot be read, and Interrupted on stop.
Plan plan_of(const catalogue::Catalogue& catalogue,
             const std::function<void(const catalogue::Item&)>& each,
             const std::stop_token& stop);

}  // namespace airtruth::build
