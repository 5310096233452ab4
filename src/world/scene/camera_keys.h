// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <variant>

#include "world/scene/scene.h"

namespace airtruth::scene {

// One key of the camera model: its name and its member of CameraModel. These are the keys that
// calibration can measure on a clip and that a camera file can state.
struct CameraKey {
  using Number = std::optional<double> CameraModel::*;
  using Colour = std::optional<std::array<double, 3>> CameraModel::*;
  // Table and key, separated by a dot.
  const char* name;
  std::variant<Number, Colour> member;
};

inline constexpr std::array<CameraKey, 12> kCameraKeys = {{
    {"shutter.exposure_s", &CameraModel::exposure_s},
    {"shutter.readout_s", &CameraModel::readout_s},
    {"air.extinction_per_km", &CameraModel::extinction_per_km},
    {"air.airlight", &CameraModel::airlight},
    {"optics.point_spread_px", &CameraModel::point_spread_px},
    {"optics.sharpening", &CameraModel::sharpening},
    {"optics.sharpening_px", &CameraModel::sharpening_px},
    {"sensor.noise_gain", &CameraModel::noise_gain},
    {"sensor.noise_floor", &CameraModel::noise_floor},
    {"sensor.noise_correlation_px", &CameraModel::noise_correlation_px},
    {"sensor.chroma_spread_px", &CameraModel::chroma_spread_px},
    {"sensor.codec_step", &CameraModel::codec_step},
}};

// Calls visit(name, member of each model) for every key, in the order of kCameraKeys.
template <typename Visit, typename... Models>
void for_each_camera_key(const Visit& visit, Models&... models) {
  for (const CameraKey& key : kCameraKeys)
    std::visit([&](auto member) { visit(key.name, models.*member...); }, key.member);
}

}  // namespace airtruth::scene
