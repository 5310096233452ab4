// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <string>

#include <airtruth/encounters.h>

#include "encounter/sets/draw_encounter.h"

// A set of encounters as a user asks for it.
namespace airtruth::sets {

// In place of a model: steady flight from stated ranges.
inline constexpr const char* kGeometric = "geometric";

struct SampleRequest : EncounterOptions {
  std::string model;  // an encounter model of MIT-LL, or kGeometric
  // What the user calls a member of this struct; for messages.
  std::function<std::string(const std::string& member)> name_of = [](const std::string& member) {
    return member;
  };

  bool is_geometric() const { return model == kGeometric; }
  std::uint64_t size() const {
    return static_cast<std::uint64_t>(std::max<std::int64_t>(0, count));
  }
};

struct SampledSet {
  DrawEncounter draw;
  // Share of the model's traffic that is in the cut, 0..1.
  double share = 1;
};

// Throws Error for files that cannot be read, for what is out of range, and for what is stated and
// has no effect, so that nobody relies on it.
SampledSet sampled_set(const SampleRequest& request);

}  // namespace airtruth::sets
