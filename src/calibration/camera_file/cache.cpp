// SPDX-License-Identifier: Apache-2.0
#include "calibration/camera_file/cache.h"

#include <nlohmann/json.hpp>

#include "foundation/base/error.h"

namespace airtruth::camera_file {
namespace {

using Json = nlohmann::ordered_json;

Json json_of(const Calibration& c) {
  Json quantities;
  for (const QuantityKey& key : kQuantityKeys) {
    const Quantity& quantity = c.quantities.*key.member;
    Json values = Json::array();
    for (const Estimate& e : quantity.values) values.push_back({e.value, e.sigma});
    quantities[key.name] = {
        {"values", values}, {"missing", quantity.missing}, {"note", quantity.note}};
  }
  Json json = {{"width", c.width},
               {"height", c.height},
               {"frames", c.frames},
               {"frame_rate_hz", c.frame_rate_hz},
               {"lens", c.lens},
               {"quantities", quantities},
               {"readout_direction", c.readout_direction},
               {"no_horizon", c.no_horizon},
               {"horizon_note", c.horizon_note},
               {"yaw_from_first_deg", c.yaw_from_first_deg}};
  if (c.downwards_s) json["downwards_s"] = {c.downwards_s->value, c.downwards_s->sigma};
  return json;
}

Estimate estimate_from(const Json& pair) { return {pair.at(0), pair.at(1)}; }

Calibration calibration_from_json(const Json& json) {
  Calibration c;
  json.at("width").get_to(c.width);
  json.at("height").get_to(c.height);
  json.at("frames").get_to(c.frames);
  json.at("frame_rate_hz").get_to(c.frame_rate_hz);
  json.at("lens").get_to(c.lens);
  for (const QuantityKey& key : kQuantityKeys) {
    const Json& kept = json.at("quantities").at(key.name);
    Quantity& quantity = c.quantities.*key.member;
    for (const Json& pair : kept.at("values")) quantity.values.push_back(estimate_from(pair));
    kept.at("missing").get_to(quantity.missing);
    kept.at("note").get_to(quantity.note);
  }
  if (json.contains("downwards_s")) c.downwards_s = estimate_from(json["downwards_s"]);
  json.at("readout_direction").get_to(c.readout_direction);
  json.at("no_horizon").get_to(c.no_horizon);
  json.at("horizon_note").get_to(c.horizon_note);
  json.at("yaw_from_first_deg").get_to(c.yaw_from_first_deg);
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
