// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "dataset/catalogue/catalogue.h"

// What a rule of [[random]] draws for a sequence, in numbers: no file is read for it.
namespace airtruth::dataset {

// How an intruder meets the camera.
struct Encounter {
  std::string aircraft;           // of the aircraft list
  double meeting_share = 0.5;     // of the clip's time, from 0.2 to 0.8: the meeting moment
  std::optional<double> range_m;  // at the meeting moment; or
  std::optional<double> size_px;
  double azimuth_deg = 0;  // from the boresight, to the right
  double elevation_deg = 0;
  double heading_deg = 0;  // at the meeting moment
  double climb_deg = 0;
  double speed_mps = 0;
  double bank_deg = 0;  // right wing down; 0: straight
};

struct DrawnSequence {
  std::size_t background = 0;
  std::vector<Encounter> encounters;  // none: a negative
  std::optional<double> sun_azimuth_deg, sun_elevation_deg;
  double start_share = 0;  // where it begins, among the places that its background has
};

// Sequence `index` of a rule: a function of rule, seed and index. The types come out even, and so
// do the liveries of each type. Of any n sequences in a row, the number of negatives is within one
// of n times their share. Sizes and ranges are even in their logarithm.
DrawnSequence draw(const Drawn& rule, std::uint64_t seed, std::int64_t index);

}  // namespace airtruth::dataset
