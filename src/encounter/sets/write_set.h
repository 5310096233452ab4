// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <stop_token>
#include <vector>

#include "encounter/sets/draw_encounter.h"
#include "encounter/track/track.h"

// A set of encounters, drawn on all cores and written to one file.
namespace airtruth::sets {

struct SetOptions {
  std::uint64_t count = 100;
  // Threads; 0: one per core. The file does not depend on it.
  int jobs = 0;
  std::function<void(std::int64_t done, std::int64_t total)> progress;
  std::stop_token stop;
};

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

// Draws encounters 0 to count - 1 and writes them in order. No more than a few thousand encounters
// stand in memory at a time, except in a format that holds a single encounter. Throws Error where
// one cannot be drawn, the format cannot hold them, or the disk refuses the file, and Interrupted
// after a stop; then no file is left.
SetSummary write_set(const std::filesystem::path& file,
                     const DrawEncounter& draw,
                     const SetOptions& options);

// The same encounters in memory, at most kMaxInMemory.
constexpr std::uint64_t kMaxInMemory = 1'000'000;
struct DrawnSet {
  std::vector<track::Encounter> encounters;
  SetSummary summary;
};
DrawnSet draw_set(const DrawEncounter& draw, const SetOptions& options);

}  // namespace airtruth::sets
