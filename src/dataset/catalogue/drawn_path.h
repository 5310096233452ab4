// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "foundation/base/seed.h"
#include "scene/scene/scene.h"
#include "scene/scene/table_reader.h"

// Paths of a rule of [[random]] that are given as a scene gives them, by closest approach or by
// what is seen, with numbers to draw.
namespace airtruth::dataset {

// A number that a rule draws: evenly from low to high, or one of a list. In a file it is a number,
// [low, high] or { any_of = [...] }.
struct DrawnNumber {
  double low = 0;
  double high = 0;
  std::vector<double> any_of;  // empty: the range holds

  double least() const;
  double greatest() const;
  double draw(Random& random) const;
  // Evenly in the logarithm, for sizes and ranges.
  double draw_in_logarithm(Random& random) const;
};

// [random.encounter]. Empty: as in a scene, but for cpa_time_s (the meeting moment) and speed_mps
// (one that suits the type).
struct DrawnApproach {
  std::optional<DrawnNumber> cpa_time_s, cpa_right_m, cpa_ahead_m, speed_mps;
  DrawnNumber cpa_above_m, climb_mps, turn_rate_dps;
  DrawnNumber course_deg{0, 360, {}};
  Where where;

  // `usual_speed_mps` stands for a speed that the rule does not state. A cpa_time_s that it does
  // not state is 0.
  scene::Encounter draw(Random random, double usual_speed_mps) const;
};

// [[random.seen]]
struct DrawnSeen {
  DrawnNumber time_s, x_px, y_px;
  std::optional<DrawnNumber> range_m, width_px;
  Where where;

  scene::Seen draw(Random& random) const;
};

// The table `encounter` of a rule; empty where it has none.
std::optional<DrawnApproach> drawn_approach_in(const scene::TableReader& rule);
// The tables `seen` of a rule. Throws Error for a single one, and where the times of two neighbours
// overlap.
std::vector<DrawnSeen> drawn_seen_in(const scene::TableReader& rule);

}  // namespace airtruth::dataset
