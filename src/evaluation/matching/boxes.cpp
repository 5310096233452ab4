// SPDX-License-Identifier: Apache-2.0
#include "evaluation/matching/boxes.h"

#include <algorithm>
#include <cmath>

namespace airtruth::matching {

double centre_distance_px(const Box& a, const Box& b) {
  return std::hypot(a.x + a.width / 2 - b.x - b.width / 2, a.y + a.height / 2 - b.y - b.height / 2);
}

double match_radius_px(const Box& truth_px, double centre_px) {
  return std::max(centre_px, std::max(truth_px.width, truth_px.height) / 2);
}

bool centre_is_in(const Box& detection_px, const Box& region_px) {
  const Pixel centre = centre_of(detection_px);
  return centre.x() >= region_px.x && centre.y() >= region_px.y && centre.x() < region_px.right() &&
         centre.y() < region_px.bottom();
}

std::optional<double> angle_mrad(const lens::Lens& lens, const Box& a, const Box& b) {
  const auto from = lens.ray_from_pixel(centre_of(a));
  const auto to = lens.ray_from_pixel(centre_of(b));
  if (!from || !to) return std::nullopt;
  // This form is accurate for small angles, where the cosine alone loses its digits.
  return 1000 * std::atan2(from->cross(*to).norm(), from->dot(*to));
}

}  // namespace airtruth::matching

namespace airtruth::evaluation {

double overlap(const Box& a, const Box& b) {
  if (!is_finite(a) || !is_finite(b)) return 0;
  const auto common = intersection(a, b);
  if (!common) return 0;
  // By rounding, x + width - x differs from width. Equal boxes are therefore handled apart, and the
  // quotient is bounded to 1.
  if (a == b) return 1;
  const double shared = common->area();
  return std::min(1.0, shared / (a.area() + b.area() - shared));
}

}  // namespace airtruth::evaluation
