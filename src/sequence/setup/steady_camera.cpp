// SPDX-License-Identifier: Apache-2.0
#include "sequence/setup/steady_camera.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "camera/motion/shake.h"
#include "foundation/geometry/transform.h"

namespace airtruth::setup {
namespace {

bool is_turned_by_its_path(const scene::Scene& scene) {
  return scene.motion.reference == scene::MotionReference::kSmoothed &&
         scene.motion.model != scene::MotionModel::kNone &&
         (scene.camera.log || scene.camera.path_file);
}

// A clip of unknown length is as long as the path.
std::int64_t frames_of(const trajectory::Path& path, const video::StreamInfo& clip) {
  const double on_path = std::floor(path.end_s() * clip.frame_rate.value()) + 1;
  if (clip.frame_count_estimate <= 0) return static_cast<std::int64_t>(on_path);
  return static_cast<std::int64_t>(
      std::min(on_path, static_cast<double>(clip.frame_count_estimate)));
}

// The mean attitudes at times k * interval_s, with k = 0, 1, ...
struct Means {
  double interval_s = 0;
  std::vector<Quaternion> world_from_body;

  // Turns on for one interval beside the first and the last frame, for the rows that a rolling
  // shutter reads there.
  Quaternion at(double time_s) const {
    const auto last = static_cast<double>(world_from_body.size() - 1);
    const double place = std::clamp(time_s / interval_s, -1.0, last + 1);
    const double before = std::clamp(std::floor(place), 0.0, last - 1);
    const auto i = static_cast<std::size_t>(before);
    const Vector3 turn =
        vector_from_rotation(world_from_body[i].conjugate() * world_from_body[i + 1]);
    return world_from_body[i] * rotation_from_vector((place - before) * turn);
  }
};

Means means_of(const trajectory::Path& path, std::int64_t frames, double rate_hz, double sigma_s) {
  std::vector<Quaternion> flown;
  std::vector<motion::FrameMotion> turns;
  for (std::int64_t k = 0; k < frames; ++k) {
    const double time_s =
        std::clamp(static_cast<double>(k) / rate_hz, path.start_s(), path.end_s());
    flown.push_back(path.at(time_s)->world_from_body);
    motion::FrameMotion turn;
    turn.time_s = static_cast<double>(k) / rate_hz;
    // In the body's axes: the mean is the same in those of the camera, which are fixed to them.
    turn.rotation = flown.back().conjugate() * flown.front();
    turns.push_back(turn);
  }
  const auto shakes = motion::smoothed(std::move(turns), {.smoothing_s = sigma_s});
  Means means{1 / rate_hz, {}};
  for (std::size_t k = 0; k < shakes.size(); ++k)
    means.world_from_body.push_back((flown[k] * *shakes[k].rotation).normalized());
  return means;
}

}  // namespace

trajectory::Path steady_camera(const trajectory::Path& path,
                               const scene::Scene& scene,
                               const video::StreamInfo& clip) {
  const double rate_hz = clip.frame_rate.value();
  if (!is_turned_by_its_path(scene) || !(rate_hz > 0)) return path;
  const std::int64_t frames = frames_of(path, clip);
  if (frames < 2) return path;
  const auto means =
      std::make_shared<const Means>(means_of(path, frames, rate_hz, scene.motion.smoothing_s));
  return trajectory::at_attitudes(
      path, [means](const trajectory::State&, double time_s) { return means->at(time_s); });
}

}  // namespace airtruth::setup
