// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "encounter/sets/draw_encounter.h"

// A set of encounters as a user asks for it.
namespace airtruth::sets {

// In place of a model: steady flight from stated ranges.
inline constexpr const char* kGeometric = "geometric";

// What is empty is not stated, and has the value beside it. Ranges are one number, or the edges of
// bins.
struct SampleRequest {
  std::string model;  // an encounter model of MIT-LL, or kGeometric
  std::string own;    // a file of encounters, whose first aircraft is the own one
  std::uint64_t count = 100;
  std::uint64_t seed = 1;
  std::optional<int> duration_s;  // that of the own track, else 60
  std::vector<std::size_t> domain, airspace;
  std::vector<double> altitude_ft;    // lowest and highest at the start
  std::optional<double> cpa_time_s;   // the middle of the own track
  std::vector<double> hmd_m;          // -500 to 500
  std::vector<double> vmd_m;          // -150 to 150
  std::vector<double> hmd_shares;     // the bins' widths
  std::vector<double> vmd_shares;     // the bins' widths
  std::vector<double> course_deg;     // -180 to 180
  std::vector<double> speed_mps;      // 30 to 80
  std::vector<double> climb_mps;      // 0
  std::vector<double> turn_rate_dps;  // 0
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

}  // namespace airtruth::sets
