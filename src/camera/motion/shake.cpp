// SPDX-License-Identifier: Apache-2.0
#include "camera/motion/shake.h"

#include <algorithm>
#include <deque>
#include <span>

#include "camera/motion/map_logarithm.h"
#include "foundation/base/error.h"

namespace airtruth::motion {
namespace {

// The number of frames on each side from which a rate is computed. With 8 the differentiator keeps
// most of a shake of 10 Hz at 30 frames/s (differentiator_weight()); a cut within that many frames
// shortens it. Doubled, it would keep a little more and join motions that are half a second apart.
constexpr int kReach = 8;

// By how much of a step the steps of frames at a constant rate may differ. Stamps of 1 ms
// (Matroska's) change a step at 240 frames/s by a quarter; a frame that is left out changes it by
// one.
constexpr double kMaxJitter = 0.3;

bool is_away(const FrameMotion& motion) { return motion.state == State::kTurnedAway; }

// Whether frame i continues the frame before it. It does not after a cut, nor where a held motion
// is next to a measured one.
bool goes_on(const std::vector<FrameMotion>& motion, std::size_t i) {
  return motion[i].state != State::kCut && is_away(motion[i]) == is_away(motion[i - 1]);
}

// The number of frames on each side of k that are linked to it at a constant rate; at most kReach.
int linked_reach(const std::vector<FrameMotion>& motion, std::size_t k) {
  int reach = 0;
  const double step_s = k + 1 < motion.size() ? motion[k + 1].time_s - motion[k].time_s : 0;
  while (reach < kReach) {
    const auto next = static_cast<std::size_t>(reach) + 1;
    if (k < next || k + next >= motion.size()) break;
    if (!goes_on(motion, k + next) || !goes_on(motion, k - next + 1)) break;
    const double after_s = motion[k + next].time_s - motion[k + next - 1].time_s;
    const double before_s = motion[k - next + 1].time_s - motion[k - next].time_s;
    const double change_s = std::max(std::abs(after_s - step_s), std::abs(before_s - step_s));
    if (change_s > kMaxJitter * step_s) break;
    ++reach;
  }
  return reach;
}

// The time between frames around frame k. That of the next frame serves where all are equal but for
// the rounding of seconds; where stamps jitter, the mean over the reach does.
double step_around(const std::vector<FrameMotion>& motion, std::size_t k, int reach) {
  const auto n = static_cast<std::size_t>(reach);
  const double next_s = motion[k + 1].time_s - motion[k].time_s;
  const double mean_s = (motion[k + n].time_s - motion[k - n].time_s) / (2 * reach);
  return std::abs(mean_s - next_s) < 1e-9 ? next_s : mean_s;
}

}  // namespace

Shake shake_of(const std::vector<FrameMotion>& motion, std::size_t k) {
  check(k < motion.size(), "a frame that was measured");
  const FrameMotion& now = motion[k];
  Shake shake{now.frame_from_reference, Homography::Zero(), now.rotation, Vector3::Zero()};
  const auto add = [&](std::size_t i, double per_s) {
    if (now.rotation)
      shake.rate_radps +=
          per_s * vector_from_rotation(*motion[i].rotation * now.rotation->conjugate());
    else
      shake.frame_from_reference_per_s +=
          per_s * (motion[i].frame_from_reference - now.frame_from_reference);
  };
  const int reach = linked_reach(motion, k);
  if (reach > 0) {
    const double step_s = step_around(motion, k, reach);
    for (int j = 1; j <= reach; ++j) {
      const auto offset = static_cast<std::size_t>(j);
      add(k + offset, differentiator_weight(j, reach) / step_s);
      add(k - offset, -differentiator_weight(j, reach) / step_s);
    }
    return shake;
  }
  // Beside a frame that is left out both neighbours count by their times; at an end of the linked
  // frames only one neighbour remains.
  const bool has_next = k + 1 < motion.size() && goes_on(motion, k + 1);
  const bool has_last = k > 0 && goes_on(motion, k);
  const double next_s = has_next ? motion[k + 1].time_s - now.time_s : 0;
  const double last_s = has_last ? now.time_s - motion[k - 1].time_s : 0;
  if (has_next) add(k + 1, has_last ? last_s / next_s / (last_s + next_s) : 1 / next_s);
  if (has_last) add(k - 1, has_next ? -next_s / last_s / (last_s + next_s) : -1 / last_s);
  return shake;
}

namespace {

Homography unit_determinant(const Homography& h) {
  // The cube root keeps the sign. A scale of h33 = 1 turns H into -H beyond a turn of 90 degrees.
  const double d = h.determinant();
  return d != 0 ? Homography(h / std::cbrt(d)) : Homography(Homography::Identity());
}

using Frames = std::span<const FrameMotion>;

// The map between neighbouring frames, b_from_a, from the composed maps.
Homography step(Frames motion, std::size_t from, std::size_t to) {
  return unit_determinant(motion[to].frame_from_reference *
                          motion[from].frame_from_reference.inverse());
}

// Where the Gaussian ends, in standard deviations: its weight there is 0.04.
constexpr double kMaxSigmas = 2.5;

double sigmas_between(const FrameMotion& from, const FrameMotion& to, double sigma_s) {
  return (to.time_s - from.time_s) / sigma_s;
}

// The shake of frame k on the group of rotations. Here every frame of the window is compared
// with frame k directly.
Quaternion shaking_rotation(Frames against_first, std::size_t k, double sigma_s) {
  Vector3 sum = Vector3::Zero();
  double total = 1;
  const auto add = [&](std::size_t i) {
    const double dt = sigmas_between(against_first[k], against_first[i], sigma_s);
    if (std::abs(dt) > kMaxSigmas) return false;
    const double weight = std::exp(-0.5 * dt * dt);
    sum += weight * vector_from_rotation(*against_first[i].rotation *
                                         against_first[k].rotation->conjugate());
    total += weight;
    return true;
  };
  for (std::size_t i = k + 1; i < against_first.size(); ++i)
    if (against_first[i].state == State::kCut || !add(i)) break;
  for (std::size_t i = k; i > 0; --i)
    if (against_first[i].state == State::kCut || !add(i - 1)) break;
  const Vector3 steady = sum / total;
  const double angle = steady.norm();
  return angle > 0 ? Quaternion(Eigen::AngleAxisd(-angle, steady / angle)) : Quaternion::Identity();
}

// The weighted sum over the neighbours of a frame.
struct NeighbourSum {
  Homography sum = Homography::Zero();
  double weight = 1;  // of the frame itself, whose logarithm is zero
};

// Adds the neighbours of frame k in one direction: log(i_from_k) with a Gaussian weight in time.
void add_neighbours(
    Frames against_first, std::size_t k, int direction, double sigma_s, NeighbourSum& all) {
  Homography i_from_k = Homography::Identity();
  std::size_t i = k;
  while (direction > 0 ? i + 1 < against_first.size() : i > 0) {
    const std::size_t next = direction > 0 ? i + 1 : i - 1;
    if (against_first[std::max(i, next)].state == State::kCut) return;
    const double dt = sigmas_between(against_first[k], against_first[next], sigma_s);
    if (std::abs(dt) > kMaxSigmas) return;
    i_from_k = unit_determinant(step(against_first, i, next) * i_from_k);
    const double weight = std::exp(-0.5 * dt * dt);
    const Homography log = logarithm(i_from_k);
    if (!log.allFinite()) return;
    all.sum += weight * log;
    all.weight += weight;
    i = next;
  }
}

// The neighbours i of frame k are compared with it by i_from_k. The steady camera is the one for
// which the weighted mean of log(i_from_k) is zero: steady_from_k = exp(sum w_i log(i_from_k)), a
// first-order mean on the group of homographies (Fletcher 2004). The frame's shake is the inverse.
// Only maps between frames that are close in time are used, since no homography describes a long
// turn. Nothing is smoothed across a cut.
Homography shaking_homography(Frames against_first, std::size_t k, double sigma_s) {
  NeighbourSum all;
  for (const int direction : {+1, -1}) add_neighbours(against_first, k, direction, sigma_s, all);
  const Homography steady_from_k = exponential(all.sum / all.weight);
  const Homography shake = steady_from_k.inverse();
  return shake.allFinite() ? Homography(shake / shake(2, 2)) : Homography(Homography::Identity());
}

// Frame k with its shake as its motion.
FrameMotion shaking(Frames against_first, std::size_t k, double sigma_s) {
  FrameMotion frame = against_first[k];
  if (frame.rotation)
    frame.rotation = shaking_rotation(against_first, k, sigma_s);
  else
    frame.frame_from_reference = shaking_homography(against_first, k, sigma_s);
  return frame;
}

}  // namespace

std::vector<FrameMotion> smoothed(std::vector<FrameMotion> motion, const Options& options) {
  check(options.smoothing_s > 0, "smoothing takes time");
  // A long clip is in memory once: the shake of a frame takes its place as soon as no window of a
  // later frame reaches back to it.
  std::size_t placed = 0;
  std::deque<FrameMotion> waiting;  // the shakes of the frames after the placed ones
  for (std::size_t k = 0; k < motion.size(); ++k) {
    waiting.push_back(shaking(Frames(motion).subspan(placed), k - placed, options.smoothing_s));
    for (; sigmas_between(motion[placed], motion[k], options.smoothing_s) > kMaxSigmas; ++placed) {
      motion[placed] = waiting.front();
      waiting.pop_front();
    }
  }
  std::ranges::copy(waiting, motion.begin() + static_cast<std::ptrdiff_t>(placed));
  return motion;
}

}  // namespace airtruth::motion
