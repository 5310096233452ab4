// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "encounter/separation/measures.h"
#include "foundation/base/seed.h"

// Random pairs of aircraft for the tests of measures and violations.
namespace airtruth::test_support {

struct Pair {
  separation::Mover own;
  separation::Mover intruder;
};

// Pair `index`. Every eighth pair is each of: any two velocities; equal velocities (the separation
// stays); the same course at another speed; both at rest; one that hovers or climbs upright; the
// same height for ever; diverging; the intruder straight above or below. Separations reach from
// metres to 20 km and 1500 m of height, speeds to 250 m/s and 25 m/s of climb.
inline Pair random_pair(std::uint64_t index) {
  Random random = Seed(20).stream("pair", index);
  const auto velocity = [&] {
    const double course = random.uniform(0, 2 * kPi);
    const double speed_mps = random.uniform(10, 250);
    return Vector3(
        speed_mps * std::cos(course), speed_mps * std::sin(course), random.uniform(-25, 25));
  };
  Pair pair;
  pair.own = {{random.uniform(-500, 500), random.uniform(-500, 500), random.uniform(-2000, -500)},
              velocity()};
  const double range_m = std::exp(random.uniform(std::log(5.0), std::log(20000.0)));
  const double bearing = random.uniform(0, 2 * kPi);
  pair.intruder = {pair.own.position_ned_m + Vector3(range_m * std::cos(bearing),
                                                     range_m * std::sin(bearing),
                                                     random.uniform(-1500, 1500)),
                   velocity()};
  separation::Mover& other = pair.intruder;
  const Vector3 offset = other.position_ned_m - pair.own.position_ned_m;
  switch (index % 8) {
    case 1:
      other.velocity_ned_mps = pair.own.velocity_ned_mps;
      break;
    case 2:
      other.velocity_ned_mps = 0.75 * pair.own.velocity_ned_mps;
      break;
    case 3:
      pair.own.velocity_ned_mps = other.velocity_ned_mps = Vector3::Zero();
      break;
    case 4:
      other.velocity_ned_mps.head<2>().setZero();
      if (index % 16 == 4) other.velocity_ned_mps.setZero();
      break;
    case 5:
      other.position_ned_m.z() = pair.own.position_ned_m.z();
      other.velocity_ned_mps.z() = pair.own.velocity_ned_mps.z();
      break;
    case 6:
      other.velocity_ned_mps = pair.own.velocity_ned_mps + offset / random.uniform(5, 500);
      break;
    case 7:
      if (index % 16 == 7) other.position_ned_m.head<2>() = pair.own.position_ned_m.head<2>();
      break;
    default:
      break;
  }
  return pair;
}

}  // namespace airtruth::test_support
