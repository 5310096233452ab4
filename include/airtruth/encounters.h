// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include <airtruth/error.h>
#include <airtruth/export.h>

// Encounters without pictures, as `airtruth encounter sample` draws them.
//
// Example: 1000 encounters of a climbing own aircraft with traffic of a model, and their share of
// those that pass within 100 m, weighted as real traffic would.
//   EncounterOptions options;
//   options.own = "own.csv";
//   options.count = 1000;
//   const SampledEncounters set = sample_encounters("light_aircraft.txt", options);
//   set.weights.size()   // 1000; rows of encounter 1 are those with set.encounter[i] == 1
namespace airtruth {

// What is empty is not stated, and has the value beside it; what is stated and has no effect is an
// Error. Ranges are one number, or the edges of bins.
struct EncounterOptions {
  // A file of encounters (docs/formats/encounters.md): each track is paired with its first
  // aircraft. Empty: tracks by themselves.
  std::string own;
  // 1 to 1,000,000.
  std::int64_t count = 100;
  std::uint64_t seed = 1;
  // Length of a track, 1 to 3600 (that of the own track, else 60).
  std::optional<int> duration_s;
  // Numbers from 1 of the model's geographic domains and airspace classes (all).
  std::vector<std::size_t> domain;
  std::vector<std::size_t> airspace;
  // Lowest and highest altitude at the start.
  std::vector<double> altitude_ft;
  // Time of the closest approach on the own track's clock (its middle).
  std::optional<double> cpa_time_s;
  // Miss distances (-500 to 500, -150 to 150), and the share of each of their bins (their widths).
  // A negative horizontal one is on the left of a head-on encounter; a positive vertical one above.
  std::vector<double> hmd_m;
  std::vector<double> hmd_shares;
  std::vector<double> vmd_m;
  std::vector<double> vmd_shares;
  // Of the model "geometric": course relative to the own one, 180 head-on, 90 from the left
  // (-180 to 180), horizontal speed (30 to 80), climb (0) and turn to the right (0).
  std::vector<double> course_deg;
  std::vector<double> speed_mps;
  std::vector<double> climb_mps;
  std::vector<double> turn_rate_dps;
  // Threads; 0: one for each core. The encounters do not depend on it.
  int jobs = 0;
  // Called as encounters are drawn, from the thread of sample_encounters().
  std::function<void(std::int64_t done, std::int64_t total)> progress;
  // sample_encounters() throws Interrupted once a stop is requested.
  std::stop_token stop;
};

struct SampledEncounters {
  // Names of an encounter's aircraft: "own" and "intruder", or "track".
  std::vector<std::string> aircraft_names;
  // How many encounters of real traffic each one stands for, up to a common factor.
  std::vector<double> weights;
  // A row for each state of each aircraft, in order. `encounter` counts from 1, `aircraft` from 0.
  std::vector<std::int64_t> encounter;
  std::vector<std::int64_t> aircraft;
  std::vector<double> time_s;
  std::vector<std::array<double, 3>> position_ned_m;
  std::vector<std::array<double, 3>> velocity_ned_mps;
  // Share of the model's traffic that domain, airspace and altitude select, 0 to 1.
  double share = 1;
  // Tracks drawn in all, those that could not be used too.
  std::int64_t draws = 0;
  // How many encounters of equal weight tell as much (Kish 1965).
  double effective_count = 0;
};

// `model`: the file of an encounter model of MIT-LL, or "geometric": steady flight from stated
// ranges. An encounter depends on the options and its number alone. Throws Error for files that
// cannot be read and for what is out of range.
AIRTRUTH_API SampledEncounters sample_encounters(const std::string& model,
                                                 const EncounterOptions& options = {});

}  // namespace airtruth
