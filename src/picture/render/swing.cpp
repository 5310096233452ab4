// SPDX-License-Identifier: Apache-2.0
#include "picture/render/swing.h"

#include <algorithm>
#include <cmath>

namespace airtruth::render {

SwingTable SwingTable::of(const aircraft::Part& part, double time_s, const Span& span) {
  SwingTable table;
  if (part.hinges.empty() || part.spins || span.is_instant()) return table;
  const double span_s = span.end_s - span.begin_s;
  const double turn_rad = 2 * kPi * aircraft::fastest_turn_per_s(part) * span_s;
  const int steps = std::max(1, static_cast<int>(std::ceil(turn_rad / kMostTurnRad)));
  table.begin_s = span.begin_s;
  table.per_s = steps / span_s;
  for (int k = 0; k <= steps; ++k) {
    const double at_s = time_s + span.begin_s + k * span_s / steps;
    table.part_from_body.push_back(aircraft::body_from_part(part, at_s).inverse(Eigen::Isometry));
  }
  return table;
}

Eigen::Affine3f SwingTable::at(double dt_s) const {
  const auto last = static_cast<double>(part_from_body.size() - 1);
  const double moment = std::clamp((dt_s - begin_s) * per_s, 0.0, last);
  const auto before = std::min(static_cast<std::size_t>(moment), part_from_body.size() - 2);
  const auto share = static_cast<float>(moment - static_cast<double>(before));
  Eigen::Affine3f pose;
  pose.matrix() =
      (1 - share) * part_from_body[before].matrix() + share * part_from_body[before + 1].matrix();
  return pose;
}

}  // namespace airtruth::render
