// SPDX-License-Identifier: Apache-2.0
#include "calibration/camera_file/cache.h"

#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "foundation/base/error.h"
#include "foundation/base/file_lock.h"
#include "foundation/base/files.h"

namespace airtruth::calibration {
namespace {

using Json = nlohmann::ordered_json;

// Version of the methods. It must be increased whenever the values of a calibration change.
constexpr int kCalibrationVersion = 6;
// Keys of texts that belong to no quantity alone.
constexpr const char* kHorizon = "horizon";
// The key that a cached calibration has beyond those of kQuantityKeys.
constexpr const char* kReadoutDirection = "shutter.readout";

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

Calibration calibration_from(const Json& json) {
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
  c.no_horizon = missing.value(kHorizon, "");
  c.horizon_note = notes.value(kHorizon, "");
  c.readout_direction = notes.value(kReadoutDirection, "");
  c.yaw_from_first_deg = json.at("yaw_from_first_deg").get<std::vector<double>>();
  return c;
}

// A lock that is held while a clip is measured; null if the folder cannot be written.
std::unique_ptr<WaitingLock> lock_in(const fs::path& folder,
                                     const CacheKey& key,
                                     const std::stop_token& stop) {
  try {
    return std::make_unique<WaitingLock>(folder / ("." + key.file_name() + ".lock"), stop);
  } catch (const Interrupted&) {
    throw;
  } catch (const std::exception&) {
    return nullptr;
  }
}

}  // namespace

std::string CacheKey::file_name() const {
  return sha256_of(fmt::format("{} {} {} {} {} {}",
                               kCalibrationVersion,
                               video_sha256,
                               mask_sha256,
                               lens,
                               altitude_m ? fmt::format("{}", *altitude_m) : "none",
                               tone.gamma)) +
         ".json";
}

std::optional<Calibration> cached(const fs::path& folder, const CacheKey& key) {
  const fs::path file = folder / key.file_name();
  std::error_code ignored;
  if (!fs::is_regular_file(file, ignored)) return std::nullopt;
  try {
    // The first line is the SHA-256 of the rest of the file.
    const std::string text = read_file(file);
    const auto line = text.find('\n');
    if (line == std::string::npos) return std::nullopt;
    const std::string body = text.substr(line + 1);
    if (text.compare(0, line, sha256_of(body)) != 0) return std::nullopt;
    return calibration_from(Json::parse(body));
  } catch (const Error&) {
    return std::nullopt;
  } catch (const Json::exception&) {
    return std::nullopt;
  }
}

void store(const fs::path& folder, const CacheKey& key, const Calibration& calibration) {
  fs::create_directories(folder);
  const std::string body = json_of(calibration).dump() + "\n";
  write_file(folder / key.file_name(), sha256_of(body) + "\n" + body);
}

Calibration calibrate_once(const fs::path& video,
                           const Options& options,
                           const fs::path& folder,
                           const CacheKey& key) {
  check(options.first_frame == 0 && !options.frame_count && options.heading_deg == 0,
        "the whole clip is calibrated, from its first frame's heading");
  if (folder.empty() || key.video_sha256.empty()) return calibrate(video, options);
  if (auto found = cached(folder, key)) return std::move(*found);
  const auto lock = lock_in(folder, key, options.stop);
  if (auto found = cached(folder, key)) return std::move(*found);
  Calibration measured = calibrate(video, options);
  try {
    store(folder, key, measured);
  } catch (const std::exception&) {
    // The folder is read-only or the disk is full: the next run measures again.
  }
  return measured;
}

}  // namespace airtruth::calibration
