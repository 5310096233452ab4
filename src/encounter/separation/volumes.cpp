// SPDX-License-Identifier: Apache-2.0
#include "encounter/separation/volumes.h"

#include <algorithm>
#include <array>

namespace airtruth::encounter {
namespace {

constexpr double kFt = kMetresPerFoot;
constexpr double kNmi = kMetresPerNauticalMile;

// The source's own units are kept in the numbers.
constexpr std::array kVolumes = {
    NamedVolume{"do365-phase1",
                {0.66 * kNmi, 450 * kFt, 35, 0},
                "RTCA DO-365B, well clear of cooperative aircraft en route (phase I)"},
    NamedVolume{"do365-preventive",
                {0.66 * kNmi, 700 * kFt, 35, 0},
                "RTCA DO-365B, preventive alert en route (phase I)"},
    NamedVolume{"do365-terminal",
                {1500 * kFt, 450 * kFt, 0, 0},
                "RTCA DO-365B, well clear in the terminal area (phase II)"},
    NamedVolume{"do365-non-cooperative",
                {2200 * kFt, 450 * kFt, 0, 0},
                "RTCA DO-365B, well clear of non-cooperative aircraft"},
    NamedVolume{"do365-buffered",
                {1 * kNmi, 450 * kFt, 35, 20},
                "NASA DAIDALUS v2, buffered well clear of DO-365 phase I"},
    NamedVolume{"f3442",
                {2000 * kFt, 250 * kFt, 0, 0},
                "ASTM F3442/F3442M-23, well clear of small unmanned aircraft"},
    NamedVolume{"nmac", {500 * kFt, 100 * kFt, 0, 0}, "RTCA DO-365B, near mid-air collision"},
};

}  // namespace

std::span<const NamedVolume> named_volumes() { return kVolumes; }

const NamedVolume* named_volume(std::string_view name) {
  const auto found = std::find_if(
      kVolumes.begin(), kVolumes.end(), [&](const NamedVolume& v) { return v.name == name; });
  return found == kVolumes.end() ? nullptr : &*found;
}

std::vector<std::string> volume_names() {
  std::vector<std::string> names;
  for (const NamedVolume& volume : kVolumes) names.emplace_back(volume.name);
  return names;
}

}  // namespace airtruth::encounter
