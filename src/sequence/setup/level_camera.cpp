// SPDX-License-Identifier: Apache-2.0
#include "sequence/setup/level_camera.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "calibration/camera_file/level.h"
#include "camera/motion/estimator.h"
#include "foundation/base/error.h"
#include "foundation/geometry/horizon_dip.h"
#include "sequence/setup/from_scene.h"

namespace airtruth::setup {
namespace {

// Every kLevelEvery-th frame of the beginning, up to a cut, with its rotation since the first.
std::vector<camera_file::SampledFrame> sampled_frames(video::Reader reader,
                                                      const lens::Lens& lens,
                                                      const image::Mask* own_aircraft,
                                                      const std::stop_token& stop) {
  std::vector<camera_file::SampledFrame> sampled;
  motion::Estimator turning(lens, motion::Options{}, own_aircraft);
  for (std::int64_t k = 0; k < kLevelFrames; ++k) {
    if (stop.stop_requested()) throw Interrupted();
    const auto frame = reader.next();
    if (!frame || (k > 0 && frame->begins_shot)) break;
    const motion::FrameMotion moved =
        turning.next(frame->picture, frame->time_s, frame->damaged, frame->begins_shot);
    if (k % kLevelEvery != 0) continue;
    sampled.push_back({frame->picture.clone(), k, {}});
    if (motion::is_known(moved.state)) sampled.back().cam_from_first = moved.rotation;
  }
  return sampled;
}

std::string level_words(const std::string& why) {
  return "[camera] has no attitude_yaw_pitch_roll_deg: it is level, since " + why;
}

}  // namespace

std::optional<YawPitchRoll> level_attitude(const scene::Camera& camera) {
  if (camera.path_file || camera.attitude_yaw_pitch_roll_deg ||
      (camera.log && !read_log(*camera.log).attitudes.empty()))
    return std::nullopt;
  const auto first = camera_path(camera).at(0);
  return YawPitchRoll{first ? yaw_pitch_roll(first->world_from_body).yaw_deg : 0, 0, 0};
}

double first_dip_rad(const scene::Camera& camera) {
  const auto first = camera_path(camera).at(0);
  return first ? horizon_dip_rad(-first->position_in_world.z()) : 0;
}

std::string state_attitude(scene::Camera& camera,
                           const lens::Lens& lens,
                           const image::Mask* own_aircraft,
                           const std::function<video::Reader()>& open,
                           const std::stop_token& stop) {
  const std::optional<YawPitchRoll> level = level_attitude(camera);
  if (!level) return "";
  YawPitchRoll& attitude = camera.attitude_yaw_pitch_roll_deg.emplace(*level);
  const auto frames = sampled_frames(open(), lens, own_aircraft, stop);
  const horizon::HorizonFinder finder(lens, own_aircraft);
  const camera_file::Horizons horizons = camera_file::accepted_horizons(finder, frames, [&] {
    if (stop.stop_requested()) throw Interrupted();
  });
  const auto cam_from_world =
      camera_file::level_attitude(frames, horizons.found, attitude.yaw_deg, first_dip_rad(camera));
  if (!cam_from_world)
    return level_words(horizons.why_none.empty() ? "no motion between its first frames is known"
                                                 : "of its first frames " + horizons.why_none);
  const YawPitchRoll found = yaw_pitch_roll(cam_from_world->conjugate() * cam_from_body());
  if (std::abs(found.roll_deg) > kMostRollDeg)
    return level_words(
        fmt::format("the horizon of its first frames stands upside down (roll {:.1f} degrees)",
                    found.roll_deg));
  attitude.pitch_deg = found.pitch_deg;
  attitude.roll_deg = found.roll_deg;
  return fmt::format(
      "[camera] has no attitude_yaw_pitch_roll_deg: pitch {:.1f} and roll {:.1f} degrees are those "
      "of the horizon in {} of its first {} frames",
      attitude.pitch_deg,
      attitude.roll_deg,
      std::ranges::count_if(horizons.found, [](const auto& one) { return one.has_value(); }),
      frames.empty() ? 0 : frames.back().frame + 1);
}

}  // namespace airtruth::setup
