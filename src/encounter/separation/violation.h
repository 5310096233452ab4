// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "encounter/separation/measures.h"

// The volumes of airspace around an aircraft that detect-and-avoid keeps others out of.
namespace airtruth::separation {

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
};

// A volume whose violation is asked for, under its name.
struct AskedVolume {
  std::string name;
  Volume volume;
};

std::span<const NamedVolume> named_volumes();
// The volume of that name; nullptr where there is none.
const NamedVolume* named_volume(std::string_view name);
std::vector<std::string> volume_names();

// A distance that is larger than a threshold by no more than this does not exceed it, so that
// aircraft which keep exactly a threshold's distance violate the volume all along, and not at every
// other instant. It is what rounding adds to a separation at positions of up to 10,000 km (2e-9 m),
// with room for the arithmetic of a path, and far below what any threshold states. Chosen.
constexpr double kRoundingM = 1e-6;

// True where the present state violates the volume, by the definition of Volume, but for
// kRoundingM.
bool is_inside(const Volume& volume, const Mover& own, const Mover& intruder);

// Times from now, in seconds.
struct Interval {
  double begin_s = 0;
  double end_s = 0;
};

// The time from now to `lookahead_s` during which two aircraft that keep their velocities violate
// the volume. It is one interval: the horizontal part is violated from the earlier root of
//   v^2 t^2 + (2 s.v + tau_s v^2) t + s^2 + tau_s s.v - D^2 = 0
// to the exit from the circle of D (Munoz et al. 2014, section 4), and the vertical part from the
// earlier of the entry into the slab and the co-altitude threshold to the exit from the slab. Empty
// where the volume is not violated within the lookahead. A volume that is only touched is violated,
// and thresholds of distance are larger by kRoundingM.
std::optional<Interval> violation(const Volume& volume,
                                  const Mover& own,
                                  const Mover& intruder,
                                  double lookahead_s);

}  // namespace airtruth::separation
