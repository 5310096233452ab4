// SPDX-License-Identifier: Apache-2.0
#include "calibration/camera_file/calibration.h"

#include <airtruth/calibration.h>

#include "calibration/camera_file/calibrate.h"
#include "calibration/camera_file/profile.h"

namespace airtruth {
Calibration calibrate(const std::vector<std::filesystem::path>& videos,
                      const CalibrateOptions& options) {
  const camera_file::Calibration found = camera_file::calibrate_camera(videos, options);
  Calibration result;
  result.width = found.width;
  result.height = found.height;
  result.frame_rate_hz = found.frame_rate_hz;
  result.frames = found.frames;
  result.clips = found.clips;
  for (const camera_file::QuantityKey& key : camera_file::kQuantityKeys) {
    result.quantities.push_back(found.quantities.*key.member);
    result.quantities.back().name = key.name;
  }
  result.readout_direction = found.readout_direction;
  result.horizons = found.horizons;
  result.no_horizon = found.no_horizon;
  result.horizon_note = found.horizon_note;
  result.toml = camera_file::toml_from(found);
  return result;
}

std::vector<CameraProfile> camera_profiles() {
  const auto known = camera_file::camera_profiles();
  return {known.begin(), known.end()};
}

}  // namespace airtruth
