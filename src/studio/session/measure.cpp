// SPDX-License-Identifier: Apache-2.0
#include "studio/session/measure.h"

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

}  // namespace airtruth::session
