// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

// The volumes of airspace around an aircraft that detect-and-avoid keeps others out of.
namespace airtruth::encounter {

constexpr double kMetresPerFoot = 0.3048;
constexpr double kMetresPerNauticalMile = 1852;

// Thresholds as of Munoz et al. 2014 (NASA/TM-2014-218280, section 2). A state violates the volume
// where it violates both parts:
//   horizontally: distance <= horizontal_m, or dcpa <= horizontal_m and 0 <= tau_mod <= tau_s with
//                 DMOD = horizontal_m;
//   vertically:   difference of height <= vertical_m, or 0 <= tcoa <= coaltitude_s.
struct Volume {
  double horizontal_m = 0;  // DTHR and DMOD
  double vertical_m = 0;    // ZTHR
  double tau_s = 0;         // TTHR
  double coaltitude_s = 0;  // TCOA threshold
};

struct NamedVolume {
  std::string_view name;
  Volume volume;
  // The document that the numbers are from.
  std::string_view source;
};

// A volume whose violation is asked for, under its name.
struct AskedVolume {
  std::string name;
  Volume volume;
};

// All named volumes.
std::span<const NamedVolume> named_volumes();
// The volume of that name; nullptr where there is none.
const NamedVolume* named_volume(std::string_view name);
std::vector<std::string> volume_names();

}  // namespace airtruth::encounter
