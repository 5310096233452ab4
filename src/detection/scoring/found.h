// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "detection/detections/detections.h"
#include "detection/scoring/truth.h"

// Whether a detection finds an aircraft. An aircraft of 6 px has an overlap below 0.5 with a box
// that lies 2 px beside it, so the rule is one of distance: a detection finds the aircraft whose
// centre lies within max(centre_px, half of the aircraft's longer side) of the detection's centre,
// the nearest where several do. Several detections may find one aircraft; none of them is a false
// alarm.
//
// Example: centre_px = 10, and an aircraft of 6 x 3 px is at (100, 100). A detection with its
// centre at (108, 106) finds it; one at (111, 100) is a false alarm. Of an aircraft of 60 x 20 px a
// detection may be 30 px away.
namespace airtruth::detection {

// Distance between the centres of two boxes.
double centre_distance_px(const Box& a, const Box& b);
// How far the centre of a detection may be from that of this aircraft.
double found_radius_px(const Box& truth_px, double centre_px);
bool centre_is_in(const Box& detection_px, const Box& region_px);

// Verdict::what of a false alarm on nothing that the truth knows.
constexpr const char* kBackground = "background";

enum class Fate {
  kFound,       // it finds an aircraft that counts
  kIgnored,     // it is on an aircraft that does not count, or in an ignored region
  kFalseAlarm,  // all others
};

struct Verdict {
  Fate fate = Fate::kFalseAlarm;
  // The object that the detection is on: the aircraft found, also one that does not count, or what
  // it mistakes for one. Empty where there is nothing, and in an ignored region.
  std::optional<std::int64_t> object;
  // Class of that object ("aircraft", "bird"), "ignore" in an ignored region, kBackground where
  // there is nothing, and the detection's own category where it does not claim an aircraft.
  std::string what;
};

// Aircraft that count come first, then those that do not, ignored regions (the centre lies in the
// region), and last other objects, by the same rule of distance as aircraft.
Verdict verdict_of(const Box& detection_px, const TruthFrame& truth, double centre_px);

// True for a detection that claims to be an aircraft: its category is no class of another object
// (<airtruth/truth.h>). A detector that names birds as birds has no false alarm on them. Types of
// aircraft ("738") are aircraft.
bool claims_aircraft(const std::string& category);

// The verdicts of a sequence, in the order of its detections. A detection that claims something
// else than an aircraft is kIgnored. Frames that only one of the two has get none.
std::vector<std::vector<Verdict>> verdicts_of(const SequenceDetections& detections,
                                              const TruthSequence& truth,
                                              double centre_px);

}  // namespace airtruth::detection
