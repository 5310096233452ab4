// SPDX-License-Identifier: Apache-2.0
#include "calibration/air/ground_track.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include <opencv2/core.hpp>

#include "calibration/air/ground_map.h"
#include "foundation/base/error.h"

namespace airtruth::air {
namespace {

// Where a constant of this file states no origin, it was chosen on the virtual flights of
// surroundings_slow_test.cpp, whose figures are in docs/realism.md.

// Lengths in heights: multiples of the camera's height above the ground.
// Size of a cell of the rectified views, and of one in the first search for the horizon, which
// takes a quarter of the cells.
constexpr double kCell = 0.1, kCoarseCell = 0.2;
// Largest distance between one view and the next.
constexpr double kMaxBetweenViews = 3;
// Distance between the views whose agreement determines the horizon.
constexpr double kFarViewDistance = 2.5;
// Search radius about the expected displacement of views that are farther apart.
constexpr double kAround = 0.4;
static_assert(2 * kFarViewDistance > kMaxBetweenViews);
// Largest displacement at which two views are compared; the rest is for rounding and for the
// neighbours of the maximum.
constexpr double kMaxDisplacement = 2 * kFarViewDistance + kAround + 2 * kCoarseCell;
// Least correlation of such views, 0 to 1, with which the path counts as followed. Below
// kMinCoarseAgreement in the coarse search the fine one is not made: over coarse and fine cells the
// correlations differed by at most 0.07 on two virtual and three real flights.
constexpr double kMinAgreement = 0.25, kMinCoarseAgreement = 0.12;
// Spacing of the tilts that are tried, degrees, and of the first, coarse search in such steps.
constexpr double kTrackTiltStepDeg = 0.25;
constexpr int kCoarse = 4, kMaxTiltSteps = static_cast<int>(kMaxTiltDeg / kTrackTiltStepDeg);
static_assert(kMaxTiltSteps % kCoarse == 0);
// Least number of views for a path.
constexpr std::size_t kMinViews = 4;

// The level axis to the right of the mean direction of view.
Vector3 right_of(const std::vector<GroundView>& views) {
  Vector3 ahead = Vector3::Zero();
  for (const GroundView& view : views) ahead += view.cam_from_world.conjugate() * Vector3(0, 0, 1);
  const Vector3 right(-ahead.y(), ahead.x(), 0);
  return right.norm() > 0 ? right.normalized() : Vector3(0, 1, 0);
}

// The registration of each view with the one before it.
std::vector<std::optional<Laid>> registrations(const GroundMaps& maps) {
  std::vector<std::optional<Laid>> next(maps.size());
  cv::parallel_for_({1, static_cast<int>(maps.size())}, [&](const cv::Range& range) {
    for (auto k = static_cast<std::size_t>(range.start); k < static_cast<std::size_t>(range.end);
         ++k)
      next[k] = maps.laid_over(k - 1, k, Eigen::Vector2d::Zero(), kMaxBetweenViews);
  });
  return next;
}

// The longest run of views that agree with the one before.
GroundTrack longest_run(const std::vector<std::optional<Laid>>& next, const GroundTrack& empty) {
  GroundTrack best, run = empty;
  const auto end_run = [&](std::size_t first) {
    if (run.places.size() > best.places.size()) best = run;
    run = empty;
    run.first = first;
  };
  for (std::size_t k = 1; k < next.size(); ++k) {
    if (next[k] && next[k]->agreement >= kMinAgreement)
      run.places.push_back(run.places.back() + next[k]->moved);
    else
      end_run(k);
  }
  end_run(next.size());
  return best;
}

// The mean agreement of views of the track that are kFarViewDistance apart; 0 without any.
double far_agreement(const GroundTrack& track, const GroundMaps& maps) {
  double sum = 0;
  int count = 0;
  for (std::size_t i = 0, j = 0; i < track.places.size(); ++i) {
    while (j < track.places.size() && (track.places[j] - track.places[i]).norm() < kFarViewDistance)
      ++j;
    if (j == track.places.size()) break;
    const Eigen::Vector2d moved = track.places[j] - track.places[i];
    if (moved.norm() > 2 * kFarViewDistance) continue;
    const auto laid = maps.laid_over(track.first + i, track.first + j, moved, kAround);
    sum += laid ? laid->agreement : 0;
    ++count;
  }
  return count > 0 ? sum / count : 0;
}

// The track under an assumed horizon, by rectified views with cells of the given size.
GroundTrack track_at(const Scenery& scenery, double horizon_rad, double cell) {
  // The assumed horizon is higher, so the direction that was level lies below it.
  const Quaternion level_from_world(Eigen::AngleAxisd(-horizon_rad, right_of(scenery.views)));
  const GroundMaps maps(scenery, level_from_world, cell, kMaxDisplacement);
  GroundTrack best = longest_run(registrations(maps),
                                 {0, {Eigen::Vector2d::Zero()}, horizon_rad, level_from_world, 0});
  best.agreement = far_agreement(best, maps);
  return best;
}

// The tilt, in steps, from which the fine search begins: the best of a coarse one. Empty where that
// is at either end of the range, or where no tilt lets the views agree. `at` gives the track at a
// number of steps by cells of a size.
std::optional<int> coarse_tilt(const std::function<GroundTrack(double, double)>& at) {
  std::vector<double> agreements;
  for (int steps = -kMaxTiltSteps; steps <= kMaxTiltSteps; steps += kCoarse)
    agreements.push_back(at(steps, kCoarseCell).agreement);
  const auto best = std::max_element(agreements.begin(), agreements.end());
  if (best == agreements.begin() || best + 1 == agreements.end() || *best < kMinCoarseAgreement)
    return std::nullopt;
  const double place =
      double(best - agreements.begin()) + peak_offset(*(best - 1), *best, *(best + 1));
  return static_cast<int>(std::lround(kCoarse * place)) - kMaxTiltSteps;
}

}  // namespace

std::optional<Eigen::Vector2d> place_on_ground(const Vector3& direction) {
  // The sine of 0.06 degrees below the horizon: ground beyond has no useful range.
  constexpr double kMinDown = 1e-3;
  if (direction.z() < kMinDown) return std::nullopt;
  return Eigen::Vector2d(direction.x(), direction.y()) / direction.z();
}

std::optional<GroundTrack> track_ground(const Scenery& scenery, const std::stop_token& stop) {
  if (scenery.views.size() < kMinViews) return std::nullopt;
  const auto at = [&](double steps, double cell) {
    if (stop.stop_requested()) throw Interrupted();
    return track_at(scenery, radians(kTrackTiltStepDeg) * steps, cell);
  };
  const auto start = coarse_tilt(at);
  if (!start) return std::nullopt;
  // The agreement by the number of tilt steps.
  std::map<int, double> known;
  const auto agreement = [&](int steps) {
    const auto [found, is_new] = known.try_emplace(steps, 0.0);
    if (is_new) found->second = at(steps, kCell).agreement;
    return found->second;
  };
  int best = *start;
  for (int climbed = 0; climbed < kCoarse; ++climbed) {
    const int next = agreement(best + 1) > agreement(best - 1) ? best + 1 : best - 1;
    if (agreement(next) <= agreement(best)) break;
    best = next;
  }
  const double before = agreement(best - 1), after = agreement(best + 1);
  GroundTrack track = at(best + peak_offset(before, agreement(best), after), kCell);
  if (track.agreement < kMinAgreement) return std::nullopt;
  return track;
}

}  // namespace airtruth::air
