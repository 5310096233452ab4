// SPDX-License-Identifier: Apache-2.0
#include <airtruth/motion.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "foundation/base/names.h"
#include "foundation/geometry/transform.h"
#include "library/pictures/public_forms.h"
#include "library/records/public_forms.h"
#include "scene/scene/scene.h"
#include "sequence/pipeline/resolved_scene.h"
#include "sequence/setup/motion_source.h"

namespace airtruth {
namespace {

template <typename Enum>
Enum choice(const char* key, const std::string& name) {
  if (const auto value = enum_named<Enum>(name)) return *value;
  throw Error(fmt::format(
      "{} is '{}'; expected one of {}", key, name, fmt::join(all_enum_names<Enum>(), ", ")));
}

FrameMotion public_motion(const motion::FrameMotion& measured) {
  FrameMotion frame;
  frame.frame = measured.frame;
  frame.time_s = measured.time_s;
  for (int i = 0; i < 9; ++i)
    frame.frame_from_reference[static_cast<std::size_t>(i)] =
        measured.frame_from_reference(i / 3, i % 3);
  if (const auto& q = measured.rotation)
    frame.cam_from_reference_cam = {q->w(), q->x(), q->y(), q->z()};
  frame.inliers = measured.inliers;
  frame.rms_px = measured.rms_px;
  frame.state = enum_name(measured.state);
  return frame;
}

}  // namespace

ClipMotion measure_motion(const std::filesystem::path& video, const MotionOptions& options) {
  setup::ClipMotionOptions how;
  how.model = choice<scene::MotionModel>("model", options.model);
  how.lens = options.lens;
  how.mask = options.mask;
  how.reference = choice<scene::MotionReference>("reference", options.reference);
  how.smoothing_s = options.smoothing_s;
  how.picture_rate_hz = options.frame_rate_hz;
  how.cache = disk_cache::Cache(pipeline::cache_folder(cache_options(options), "motion"));
  how.warn = options.warn;
  how.progress = options.progress;
  how.stop = options.stop;
  const setup::ClipMotion found = setup::clip_motion(video, how);
  ClipMotion result{found.info.width, found.info.height, {}, {}, {}};
  if (found.lens) result.lens = public_lens(*found.lens);
  for (const motion::FrameMotion& frame : found.frames)
    result.frames.push_back(public_motion(frame));
  if (found.gyro)
    result.gyro = {found.gyro->correlation, found.gyro->offset_s, degrees(found.gyro->rms_radps)};
  return result;
}

}  // namespace airtruth
