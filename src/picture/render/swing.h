// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "aircraft/model/mesh.h"
#include "picture/render/ray_grid.h"

namespace airtruth::render {

// The poses of a part that swings on hinges, at even moments of a span. Each ray has its own time,
// and a pose costs more than a ray. Between two moments the pose is interpolated linearly: they are
// so near that no point is off by more than kMostTurnRad^2 / 8 of its distance from the hinge.
struct SwingTable {
  static constexpr double kMostTurnRad = 0.01;
  double begin_s = 0;  // from the instance's time
  double per_s = 0;    // moments a second
  std::vector<Eigen::Affine3f> part_from_body;

  // Without moments for a part that does not swing, and where the span is an instant.
  static SwingTable of(const aircraft::Part& part, double time_s, const Span& span);
  bool empty() const { return part_from_body.empty(); }
  // `dt_s`: from the instance's time, within the span.
  Eigen::Affine3f at(double dt_s) const;
};

}  // namespace airtruth::render
