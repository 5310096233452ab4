// SPDX-License-Identifier: Apache-2.0
#include "dataset/stream/fleet.h"

#include <algorithm>

#include "dataset/catalogue/table_values.h"
#include "encounter/pairing/strata.h"
#include "foundation/base/seed.h"

namespace airtruth::stream {

std::vector<catalogue::AircraftType> fleet_of(const std::vector<catalogue::AircraftType>& types,
                                              std::uint64_t seed,
                                              std::int64_t index,
                                              bool every_type) {
  std::size_t liveries = 0;
  for (const catalogue::AircraftType& type : types) liveries += type.liveries.size();
  if (liveries <= kFleet) return types;
  const std::size_t count = every_type ? std::max(kFleet, types.size()) : kFleet;
  const pairing::Strata turns(Seed(seed).stream("turns of types")(), types.size(), 1);
  std::vector<catalogue::AircraftType> fleet;
  for (std::size_t slot = 0; slot < count; ++slot) {
    const auto begin =
        static_cast<std::int64_t>(slot) * kSamplesOfAircraft / static_cast<std::int64_t>(count);
    const auto number =
        static_cast<std::uint64_t>((index + begin) / kSamplesOfAircraft) * count + slot;
    Random random = Seed(seed).stream("aircraft", number);
    const catalogue::AircraftType& type =
        catalogue::one_at(turns.spaced((every_type ? slot : number) % types.size(), 0), types);
    fleet.push_back({type.name, {catalogue::one_of(random, type.liveries)}});
  }
  return fleet;
}

}  // namespace airtruth::stream
