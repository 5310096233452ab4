// SPDX-License-Identifier: Apache-2.0
#include "sequence/resolve.h"

#include "base/error.h"

namespace airtruth::sequence {

scene::Scene resolved(const scene::Scene& scene, const video::StreamInfo& info) {
  scene::Scene result = scene;
  scene::CameraModel& model = result.camera_model;
  if (model.angle_deg) {
    const double rate_hz = info.frame_rate.value();
    if (!(rate_hz > 0))
      throw Error("has no frame rate, which shutter.angle_deg is a share of; expected exposure_s",
                  {scene.background.video.string()});
    model.exposure_s = *model.angle_deg / 360 / rate_hz;
    model.angle_deg.reset();
  }
  return result;
}

}  // namespace airtruth::sequence
