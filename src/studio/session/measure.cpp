// SPDX-License-Identifier: Apache-2.0
#include "studio/session/measure.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include "sequence/pipeline/resolved_scene.h"
#include "sequence/setup/from_scene.h"
#include "sequence/setup/shared_inputs.h"

namespace airtruth::session {

std::string motion_key(const scene::Scene& scene) {
  return key_of(scene, [&](scene::Scene& part) {
    part.lens = scene.lens;
    part.motion = scene.motion;
    // Whether there is a shutter.
    part.camera_model.exposure_s = scene.camera_model.exposure_s;
    part.camera_model.readout_s = scene.camera_model.readout_s;
    part.camera_model.angle_deg = scene.camera_model.angle_deg;
  });
}

std::string calibration_key(const scene::Scene& scene) {
  return key_of(scene, [&](scene::Scene& part) {
    part.lens = scene.lens;
    // Of the camera's place the height alone counts.
    part.camera.position_ned_m = {0, 0, scene.camera.position_ned_m.z()};
    part.camera.path_file = scene.camera.path_file;
    part.camera.log = scene.camera.log;
    part.camera_model.gamma = scene.camera_model.gamma;
  });
}

std::shared_ptr<const setup::MotionSource> motion_of(
    const scene::Scene& scene,
    const pipeline::Options& options,
    const std::function<void(std::int64_t done, std::int64_t total)>& progress) {
  video::Reader reader = pipeline::open_background(scene, options);
  const video::StreamInfo info = reader.info();
  const lens::ImageSize size{info.width, info.height};
  scene::Scene plain = pipeline::stated(scene, info).scene;
  // As a preview draws it.
  plain.motion.model = setup::motion_model(scene);
  plain.composite.method = scene::CompositeMethod::kMatte;
  std::shared_ptr<const image::Mask> mask;
  if (plain.background.mask) mask = options.shared->mask_of(*plain.background.mask, size);
  const lens::Lens lens = setup::lens_of(plain.lens, size);
  const std::filesystem::path cache = pipeline::cache_folder(options, "motion");
  const setup::MotionInputs inputs{plain,
                                   lens,
                                   !setup::shutter_of(plain.camera_model).is_instant(),
                                   setup::sha256_of_video(plain.background.video, *options.shared),
                                   mask.get(),
                                   cache.empty() ? disk_cache::Cache() : disk_cache::Cache(cache)};
  const std::int64_t total = plain.background.frame_count.value_or(
      std::max<std::int64_t>(1, info.frame_count_estimate - plain.background.first_frame));
  auto source = std::make_shared<setup::MotionSource>(
      inputs,
      setup::MotionPass{.for_all = true,
                        .open = [&] { return std::move(reader); },
                        .stop = options.stop,
                        .seen = [&](std::int64_t done) { progress(done, total); }});
  source->store();
  return source;
}

}  // namespace airtruth::session
