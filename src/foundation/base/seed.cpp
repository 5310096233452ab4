// SPDX-License-Identifier: Apache-2.0
#include "foundation/base/seed.h"

#include <cmath>
#include <numbers>

namespace airtruth {

double Random::uniform() { return static_cast<double>((*this)() >> 11) * 0x1.0p-53; }

double Random::uniform(double low, double high) { return low + (high - low) * uniform(); }

double Random::normal() {
  const double u = 1.0 - uniform();
  const double v = uniform();
  return std::sqrt(-2.0 * std::log(u)) * std::cos(2.0 * std::numbers::pi * v);
}

Random Seed::stream(std::string_view name) const { return stream(name, 0); }

Random Seed::stream(std::string_view name, std::uint64_t index) const {
  std::uint64_t hash = 0xcbf29ce484222325ULL;  // FNV-1a
  for (const unsigned char c : name) hash = (hash ^ c) * 0x100000001b3ULL;
  return Random(mixed(mixed(value_ + 0x9e3779b97f4a7c15ULL) ^ hash) +
                index * 0xd1342543de82ef95ULL);
}

}  // namespace airtruth
