// SPDX-License-Identifier: Apache-2.0
#include "calibration/camera_file/cache.h"

#include <nlohmann/json.hpp>

#include "foundation/base/error.h"

namespace airtruth::camera_file {
namespace {

using Json = nlohmann::ordered_json;

// Keys of texts that belong to no quantity alone.
constexpr const char* kHorizon = "horizon";
// The keys that a cached calibration has beyond those of kQuantityKeys.
constexpr const char* kReadoutDirection = "shutter.readout";
constexpr const char* kDownwards = "shutter.downwards_s";

Json json_of(const Calibration& c) {
  Json values = Json::object(), missing = Json::object(), notes = Json::object();
  const auto add = [](Json& object, const char* key, const std::string& text) {
    if (!text.empty()) object[key] = text;
  };
  for (const QuantityKey& key : kQuantityKeys) {
    const Quantity& quantity = c.quantities.*key.member;
    Json list = Json::array();
    for (const Estimate& e : quantity.values) list.push_back({e.value, e.sigma});
    if (!list.empty()) values[key.name] = list;
    add(missing, key.name, quantity.missing);
    add(notes, key.name, quantity.note);
  }
  if (c.downwards_s) values[kDownwards] = {c.downwards_s->value, c.downwards_s->sigma};
  add(missing, kHorizon, c.no_horizon);
  add(notes, kHorizon, c.horizon_note);
  add(notes, kReadoutDirection, c.readout_direction);
  return {{"width", c.width},
          {"height", c.height},
          {"frames", c.frames},
          {"frame_rate_hz", c.frame_rate_hz},
          {"lens", c.lens},
          {"values", values},
          {"missing", missing},
          {"notes", notes},
          {"yaw_from_first_deg", c.yaw_from_first_deg}};
}

Calibration calibration_from_json(const Json& json) {
  Calibration c;
  c.width = json.at("width");
  c.height = json.at("height");
  c.frames = json.at("frames");
  c.frame_rate_hz = json.at("frame_rate_hz");
  c.lens = json.at("lens").get<std::string>();
  const Json &values = json.at("values"), &missing = json.at("missing"), &notes = json.at("notes");
  for (const QuantityKey& key : kQuantityKeys) {
    Quantity& quantity = c.quantities.*key.member;
    for (const Json& estimate : values.value(key.name, Json::array()))
      quantity.values.push_back({estimate.at(0).get<double>(), estimate.at(1).get<double>()});
    quantity.missing = missing.value(key.name, "");
    quantity.note = notes.value(key.name, "");
  }
  if (values.contains(kDownwards))
    c.downwards_s = {values[kDownwards].at(0).get<double>(),
                     values[kDownwards].at(1).get<double>()};
  c.no_horizon = missing.value(kHorizon, "");
  c.horizon_note = notes.value(kHorizon, "");
  c.readout_direction = notes.value(kReadoutDirection, "");
  c.yaw_from_first_deg = json.at("yaw_from_first_deg").get<std::vector<double>>();
  return c;
}

Calibration calibration_from(const std::string& body) {
  try {
    return calibration_from_json(Json::parse(body));
  } catch (const Json::exception& error) {
    throw Error(error.what());
  }
}

}  // namespace

disk_cache::Key CacheKey::entry() const {
  disk_cache::Key key("calibration");
  key.add(video_sha256).add(mask_sha256).add(lens).add(altitude_m.has_value());
  key.add(altitude_m.value_or(0)).add(tone.gamma);
  if (picture_rate_hz) key.add(*picture_rate_hz);
  return key;
}

std::optional<Calibration> cached(const disk_cache::Cache& cache, const CacheKey& key) {
  return cache.find(key.entry(), calibration_from);
}

void store(const disk_cache::Cache& cache, const CacheKey& key, const Calibration& calibration) {
  cache.keep(key.entry(), json_of(calibration).dump());
}

Calibration calibrate_once(const fs::path& video,
                           const Options& options,
                           const disk_cache::Cache& cache,
                           const CacheKey& key) {
  check(options.heading_deg == 0, "a clip is calibrated from its first frame's heading");
  if (!cache.keeps() || key.video_sha256.empty()) return calibrate(video, options);
  if (auto found = cached(cache, key)) return std::move(*found);
  const auto lock = cache.lock(key.entry(), options.stop);
  if (auto found = cached(cache, key)) return std::move(*found);
  Calibration measured = calibrate(video, options);
  store(cache, key, measured);
  return measured;
}

}  // namespace airtruth::camera_file
