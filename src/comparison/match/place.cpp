// SPDX-License-Identifier: Apache-2.0
#include "comparison/match/place.h"

#include <algorithm>
#include <cmath>

#include "foundation/base/error.h"
#include "foundation/geometry/box.h"
#include "labels/projection/exact_box.h"
#include "scene/trajectory/path.h"

namespace airtruth::match {
namespace {

// Where a constant of this file states no origin, it is a choice.

// Share of the range that it moves from frame to frame at least: far below a pixel.
constexpr double kStandsStill = 1e-7;
constexpr double kAway = 1.15;  // patches from the real one's middle: the two do not overlap

struct Spot {
  std::int64_t frame = 0;
  Pixel centre;
  double size_px = 0;
};

// Every frame from the first box to the last: places between boxes by straight lines, sizes by the
// mean of a second's worth around.
std::vector<Spot> spots_of(const RealBoxes& boxes) {
  std::vector<Spot> spots;
  for (auto it = boxes.begin(); it != boxes.end(); ++it) {
    const auto& [frame, box] = *it;
    const auto next = std::next(it);
    const std::int64_t until = next == boxes.end() ? frame + 1 : next->first;
    for (std::int64_t k = frame; k < until; ++k) {
      const double t = double(k - frame) / double(until - frame);
      const Box& after = next == boxes.end() ? box : next->second;
      const Pixel here = centre_of(box), there = centre_of(after);
      spots.push_back({k, here + t * (there - here), std::max(box.width, box.height)});
    }
  }
  // Number of frames to each side: a second's worth at 30 frames/s.
  constexpr int kReach = 15;
  std::vector<Spot> smooth = spots;
  for (std::size_t i = 0; i < spots.size(); ++i) {
    double sum = 0, weight = 0;
    Pixel place = Pixel::Zero();
    double near = 0;
    for (int d = -kReach; d <= kReach; ++d) {
      const auto j = static_cast<std::int64_t>(i) + d;
      if (j < 0 || j >= static_cast<std::int64_t>(spots.size())) continue;
      const Spot& s = spots[static_cast<std::size_t>(j)];
      sum += s.size_px, weight += 1;
      // A box is drawn to the pixel: its middle is smoothed over three frames.
      const double w = std::exp(-0.5 * d * d);
      place += w * s.centre, near += w;
    }
    smooth[i].size_px = sum / weight;
    smooth[i].centre = place / near;
  }
  return smooth;
}

// To which side there is room in most frames: in units of the real one's patch.
Pixel side_of(const std::vector<Spot>& spots, const lens::ImageSize& size) {
  Pixel best(0, 0);
  std::size_t most = 0;
  for (const Pixel& side : {Pixel(1, 0), Pixel(-1, 0), Pixel(0, -1), Pixel(0, 1)}) {
    std::size_t inside = 0;
    for (const Spot& s : spots) {
      const double patch = 2 * std::max(8.0, s.size_px);
      const Pixel p = s.centre + kAway * patch * side;
      const double half = patch / 2 + 2;
      inside +=
          p.x() > half && p.y() > half && p.x() < size.width - half && p.y() < size.height - half
              ? 1
              : 0;
    }
    if (inside > most) most = inside, best = side;
  }
  return best;
}

// The range along `direction`, in metres, at which the larger side of the aircraft's box is
// `size_px`. `range_m` is a first guess.
double range_of_size(const projection::Sight& sight,
                     const projection::SilhouettePoints& silhouette,
                     const Quaternion& world_from_aircraft,
                     const Vector3& direction,
                     double size_px,
                     double range_m) {
  for (int round = 0; round < 4; ++round) {
    const auto box =
        projection::exact_box(sight, silhouette, {world_from_aircraft, range_m * direction}, 0).box;
    if (!box) throw Error("the intruder cannot be drawn where it would be placed");
    range_m *= std::max(box->width, box->height) / size_px;
  }
  return range_m;
}

// Continues the path a little beyond the last frame, so that the frame is part of it.
void extend(Beside& path, double end_s) {
  if (path.times_s.size() < 2)
    throw Error("the real aircraft stands still in the picture; nothing can fly beside it");
  const Vector3 last = path.waypoints_ned_m.back();
  path.waypoints_ned_m.push_back(
      last + (last - path.waypoints_ned_m[path.times_s.size() - 2]) * 1e-3 + Vector3(1e-6, 0, 0));
  path.times_s.push_back(end_s);
}

// The direction in cam of the place beside a spot.
Vector3 direction_beside(const Spot& spot, const Pixel& side, const lens::Lens& lens) {
  const Pixel place = spot.centre + kAway * 2 * std::max(8.0, spot.size_px) * side;
  const Pixel bounded(std::clamp(place.x(), 1.0, lens.size().width - 1.0),
                      std::clamp(place.y(), 1.0, lens.size().height - 1.0));
  const auto ray = lens.ray_from_pixel(bounded);
  if (!ray) throw Error("the lens has no direction where the intruder would be placed");
  return *ray;
}

}  // namespace

Beside path_beside(const RealBoxes& boxes,
                   const model::Mesh& mesh,
                   const YawPitchRoll& attitude,
                   const lens::Lens& lens,
                   double frame_rate_hz,
                   double scale) {
  const std::vector<Spot> spots = spots_of(boxes);
  const Pixel side = side_of(spots, lens.size());
  if (side.isZero())
    throw Error("there is no room in the picture beside the real aircraft at its own size");
  const projection::SilhouettePoints silhouette{&mesh, model::silhouette_points(mesh)};
  const Quaternion turned = world_from_body(attitude);
  const Rigid world_from_cam{cam_from_body().conjugate(), Vector3::Zero()};
  const projection::Sight sight{&lens, world_from_cam.inverse(), Homography::Identity()};
  const model::Extents extents = model::extents(mesh);
  Beside path;
  double range_m = 0;
  for (const Spot& spot : spots) {
    const Vector3 direction = world_from_cam.rotation * direction_beside(spot, side, lens);
    if (range_m <= 0)
      range_m =
          lens.focal_px() * std::max(extents.length_m(), extents.span_m()) / (scale * spot.size_px);
    range_m = range_of_size(sight, silhouette, turned, direction, scale * spot.size_px, range_m);
    const Vector3 p = range_m * direction;
    // A path's points stand apart; where the real one stands still, so does ours.
    if (!path.waypoints_ned_m.empty() &&
        (path.waypoints_ned_m.back() - p).norm() <= kStandsStill * p.norm())
      continue;
    path.waypoints_ned_m.push_back(p);
    path.times_s.push_back(double(spot.frame - spots.front().frame) / frame_rate_hz);
  }
  extend(path, double(spots.back().frame - spots.front().frame + 1) / frame_rate_hz);
  return path;
}

double camera_pitch_deg(const YawPitchRoll& attitude) {
  // The steepest camera that is tried.
  constexpr int kSteepestDeg = 60;
  const Vector3 up = world_from_body(attitude) * Vector3(0, 0, -1);
  int best = 0;
  double most = -2;
  for (int pitch_deg = 0; pitch_deg <= kSteepestDeg; ++pitch_deg) {
    const double upright = -(world_from_body({0, double(pitch_deg), 0}) * up).z();
    if (upright > most + 1e-9) most = upright, best = pitch_deg;
  }
  return best;
}

void look_up(double pitch_deg, Beside& path, YawPitchRoll& attitude) {
  const Quaternion turn = world_from_body({0, pitch_deg, 0});
  for (Vector3& point : path.waypoints_ned_m) point = turn * point;
  attitude = yaw_pitch_roll(turn * world_from_body(attitude));
}

void set_off(const Vector3& level_ned_mps, Beside& path) {
  // A motion that is added to all waypoints is added to the spline through them.
  const auto seen = trajectory::spline_at_times(path.waypoints_ned_m, path.times_s).at(0);
  Vector3& camera_mps = path.camera_velocity_ned_mps;
  camera_mps = level_ned_mps - seen->velocity_in_world_mps;
  camera_mps.z() = 0;
  for (std::size_t i = 0; i < path.times_s.size(); ++i)
    path.waypoints_ned_m[i] += path.times_s[i] * camera_mps;
}

}  // namespace airtruth::match
