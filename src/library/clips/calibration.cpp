// SPDX-License-Identifier: Apache-2.0
#include "calibration/camera_file/calibration.h"

#include <airtruth/calibration.h>

#include "calibration/camera_file/calibrate.h"
#include "calibration/camera_file/profile.h"
#include "calibration/camera_file/quantities.h"

namespace airtruth {
namespace {

CalibratedQuantity public_quantity(const char* name, const camera_file::Quantity& found) {
  CalibratedQuantity quantity{name, {}, found.missing, found.note, found.source, found.doubt};
  for (const measured::Estimate& one : found.values)
    quantity.values.push_back({one.value, one.sigma});
  return quantity;
}

}  // namespace

Calibration calibrate(const std::vector<std::filesystem::path>& videos,
                      const CalibrateOptions& options) {
  camera_file::CameraOptions how;
  how.lens = options.lens;
  how.mask = options.mask;
  how.altitude_m = options.altitude_m;
  how.heading_deg = options.heading_deg;
  how.gamma = options.gamma;
  how.profile = options.profile;
  how.warn = options.warn;
  how.progress = options.progress;
  how.stop = options.stop;
  const camera_file::Calibration found = camera_file::calibrate_camera(videos, how);
  Calibration result;
  result.width = found.width;
  result.height = found.height;
  result.frame_rate_hz = found.frame_rate_hz;
  result.frames = found.frames;
  result.clips = found.clips;
  for (const camera_file::QuantityKey& key : camera_file::kQuantityKeys)
    result.quantities.push_back(public_quantity(key.name, found.quantities.*key.member));
  result.readout_direction = found.readout_direction;
  for (const camera_file::FrameHorizon& one : found.horizons)
    result.horizons.push_back({one.frame, one.pitch_deg, one.roll_deg});
  result.no_horizon = found.no_horizon;
  result.horizon_note = found.horizon_note;
  result.toml = camera_file::toml_from(found);
  return result;
}

std::vector<CameraProfile> camera_profiles() {
  std::vector<CameraProfile> profiles;
  for (const camera_file::CameraProfile& one : camera_file::camera_profiles())
    profiles.push_back({one.name, one.camera, one.width, one.height, one.clips});
  return profiles;
}

}  // namespace airtruth
