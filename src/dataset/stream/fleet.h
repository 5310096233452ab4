// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "dataset/catalogue/drawn_rule.h"

namespace airtruth::stream {

// How many aircraft a rule flies at a time, and for how many samples each does. A livery takes as
// long to load as tens of samples take to draw, and the hundreds of a catalogue are too many for
// memory. One aircraft changes every 512 samples. Chosen.
inline constexpr std::size_t kFleet = 16;
inline constexpr std::int64_t kSamplesOfAircraft = 8192;

// The aircraft of `types` that fly in sample `index`: types take turns, and a livery of each is
// drawn. All of them where they are no more than kFleet. With `every_type`, one of each type where
// there are more types than that.
std::vector<catalogue::AircraftType> fleet_of(const std::vector<catalogue::AircraftType>& types,
                                              std::uint64_t seed,
                                              std::int64_t index,
                                              bool every_type);

}  // namespace airtruth::stream
