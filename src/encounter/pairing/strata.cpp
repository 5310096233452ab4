// SPDX-License-Identifier: Apache-2.0
#include "encounter/pairing/strata.h"

#include <algorithm>

#include "foundation/base/error.h"
#include "foundation/base/seed.h"

namespace airtruth::pairing {

Strata::Strata(std::uint64_t seed, std::uint64_t count, std::size_t dimensions)
    : seed_(seed), count_(count), offset_(Seed(seed).stream("offset in the stratum").uniform()) {
  check(count >= 1, "there are strata");
  while (half_bits_ < 32 && (std::uint64_t{1} << (2 * half_bits_)) < count) ++half_bits_;
  for (std::size_t dimension = 0; dimension < dimensions; ++dimension) {
    Random random = Seed(seed).stream("strata", dimension);
    std::array<std::uint64_t, kRounds> keys{};
    for (std::uint64_t& key : keys) key = random();
    keys_.push_back(keys);
  }
}

std::uint64_t Strata::stratum(std::uint64_t index, std::size_t dimension) const {
  const std::uint64_t mask = (std::uint64_t{1} << half_bits_) - 1;
  std::uint64_t value = index;
  do {
    std::uint64_t left = value >> half_bits_;
    std::uint64_t right = value & mask;
    for (const std::uint64_t key : keys_[dimension]) {
      const std::uint64_t next = left ^ (Random(key ^ right)() & mask);
      left = right;
      right = next;
    }
    value = left << half_bits_ | right;
  } while (value >= count_);
  return value;
}

double Strata::at(std::uint64_t index, std::size_t dimension) const {
  const std::uint64_t place = index * keys_.size() + dimension;
  return place_of(stratum(index, dimension),
                  Seed(seed_).stream("within the stratum", place).uniform());
}

double Strata::spaced(std::uint64_t index, std::size_t dimension) const {
  return place_of(stratum(index, dimension), offset_);
}

double Strata::place_of(std::uint64_t stratum, double within) const {
  // The largest double below 1.
  constexpr double kLargestBelow1 = 1 - 0x1.0p-53;
  return std::min((static_cast<double>(stratum) + within) / static_cast<double>(count_),
                  kLargestBelow1);
}

}  // namespace airtruth::pairing
