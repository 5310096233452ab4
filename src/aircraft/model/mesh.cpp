// SPDX-License-Identifier: Apache-2.0
#include "aircraft/model/mesh.h"

#include <algorithm>
#include <cmath>

namespace airtruth::aircraft {
namespace {

// 0 below 0, 1 above 1, with a continuous slope.
double smooth_step(double x) {
  const double u = std::clamp(x, 0.0, 1.0);
  return u * u * (3 - 2 * u);
}

// The strength of a stroke: 1 within a bout, 0 in a glide. It changes over one stroke.
double strength(const Beat& beat, double strokes) {
  if (!(beat.glide > 0)) return 1;
  const double bouts = strokes / kStrokesOfBout;
  const double at = (bouts - std::floor(bouts)) * kStrokesOfBout;
  const double end = (1 - beat.glide) * kStrokesOfBout;
  return smooth_step(at) * (1 - smooth_step(at - end + 1));
}

void turn_about(Eigen::Affine3f& pose,
                const Eigen::Vector3f& centre,
                const Eigen::Vector3f& axis,
                float angle_rad) {
  pose.translate(centre);
  pose.rotate(Eigen::AngleAxisf(angle_rad, axis.normalized()));
  pose.translate(-centre);
}

void swing(Eigen::Affine3f& pose, const Hinge& hinge, const Beat& beat, double time_s) {
  const double strokes = beat.strokes_per_s * time_s + beat.phase_strokes;
  const double wave = std::sin(2 * kPi * (strokes - double(hinge.lag_strokes)));
  const double angle_rad =
      double(hinge.rest_rad) + strength(beat, strokes) * wave * double(hinge.amplitude_rad);
  turn_about(pose, hinge.centre_in_body, hinge.axis_in_body, static_cast<float>(angle_rad));
}

}  // namespace

std::size_t Mesh::triangle_count() const {
  std::size_t count = 0;
  for (const Part& part : parts) count += part.triangles.size();
  return count;
}

Eigen::Affine3f body_from_part(const Part& part, double time_s) {
  Eigen::Affine3f result = Eigen::Affine3f::Identity();
  for (const Hinge& hinge : part.hinges) swing(result, hinge, part.beat, time_s);
  if (!part.spins) return result;
  const double turns = part.revolutions_per_s * time_s;
  const auto angle = static_cast<float>(2 * kPi * (turns - std::floor(turns)));
  turn_about(result, part.centre_in_body, part.axis_in_body, angle);
  return result;
}

float reach_m(const Mesh& mesh, const Part& part) {
  // A point keeps its distance from the last hinge, and each hinge its distance from the one
  // before.
  Eigen::Vector3f from = part.centre_in_body;
  float of_hinges_m = 0;
  for (const Hinge& hinge : part.hinges) {
    of_hinges_m += (hinge.centre_in_body - from).norm();
    from = hinge.centre_in_body;
  }
  float of_points_m = 0;
  for (const Triangle& triangle : part.triangles)
    for (const std::uint32_t v : triangle.vertex)
      of_points_m = std::max(of_points_m, (mesh.positions[v] - from).norm());
  return of_hinges_m + of_points_m;
}

double fastest_turn_per_s(const Part& part) {
  double turns_per_s = part.spins ? std::abs(part.revolutions_per_s) : 0;
  // The slope of smooth_step is 1.5 at most, beside that of the wave, 2 pi.
  constexpr double kSteepest = 2 * kPi + 2 * 1.5;
  for (const Hinge& hinge : part.hinges)
    turns_per_s += kSteepest / (2 * kPi) * std::abs(part.beat.strokes_per_s) *
                   std::abs(double(hinge.amplitude_rad));
  return turns_per_s;
}

}  // namespace airtruth::aircraft
