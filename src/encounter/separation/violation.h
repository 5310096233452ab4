// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "encounter/separation/measures.h"
#include "encounter/separation/volumes.h"

namespace airtruth::encounter {

// True where the present state violates the volume, by the definition of Volume.
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
// where the volume is not violated within the lookahead. A volume that is only touched is violated.
std::optional<Interval> violation(const Volume& volume,
                                  const Mover& own,
                                  const Mover& intruder,
                                  double lookahead_s);

}  // namespace airtruth::encounter
