// SPDX-License-Identifier: Apache-2.0
#include "runners/runs/detector_results.h"

#include <algorithm>

#include <airtruth/version.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/json/settings_record.h"

namespace airtruth::runs {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kRecord = "detector.json";

Json settings_of(const association::AssociationOptions& association) {
  const auto& score = association.confident_score;
  return {{"declare", fmt::format("{}/{}", association.declare_m, association.declare_n)},
          {"confident_score", score ? Json(*score) : Json()}};
}

// The command without the folder of its files, which are known by their content.
std::string recorded(const std::string& command) {
  const std::vector<fs::path> files = files_of(command);
  if (files.empty()) return command;
  return command.substr(0, command.find(':') + 1) + files.front().filename().string();
}

// What decides the bytes of the results.
Json settings_of(const DetectorName& detector, const DetectOptions& options) {
  Json settings = {{"detector", recorded(detector.command)},
                   {"max_per_frame", options.max_per_frame}};
  settings["min_score"] = options.min_score ? Json(*options.min_score) : Json();
  settings["lens"] = options.lens ? Json(sha256_of_file(*options.lens)) : Json();
  settings["mask"] = options.mask && options.masks ? Json(sha256_of_file(*options.mask)) : Json();
  settings["masks"] = options.masks;
  settings["mask_results"] = options.mask_results;
  settings["association"] = options.association ? settings_of(*options.association) : Json();
  settings["files"] = Json::object();
  for (const fs::path& file : files_of(detector.command)) {
    settings["files"][file.filename().string()] = sha256_of_file(file);
  }
  return settings;
}

}  // namespace

DetectorResults::DetectorResults(const DetectorName& detector,
                                 const fs::path& out,
                                 const DetectOptions& options)
    : detector_(detector), options_(options) {
  summary_.name = detector.name;
  summary_.folder = out / detector.name;
  is_open();
}

bool DetectorResults::is_open() const {
  // settings_of() throws Error for a lens that is not there, also before there is a folder.
  return is_record_of(summary_.folder / kRecord, settings_of(detector_, options_));
}

void DetectorResults::open() const {
  if (is_open()) return;
  std::error_code failed;
  fs::create_directories(summary_.folder, failed);
  if (failed) throw Error("cannot create: " + failed.message(), {summary_.folder.string()});
  Json record = settings_of(detector_, options_);
  record["name"] = detector_.name;
  record["format"] = "airtruth detections 1";
  record["version"] = kVersion;
  write_file(summary_.folder / kRecord, record.dump(1) + "\n");
}

bool DetectorResults::keeps(const std::string& part, const std::string& sequence) {
  if (!results::has_sequence(summary_.folder / part, sequence)) return false;
  const std::lock_guard lock(mutex_);
  ++summary_.kept;
  return true;
}

void DetectorResults::add(const std::string& part,
                          const results::SequenceDetections& detections,
                          const std::string& log) {
  const fs::path folder = summary_.folder / part;
  fs::create_directories(folder);
  write_log(detections.name, log);
  results::write_sequence(folder, detections);
  const std::lock_guard lock(mutex_);
  ++summary_.made;
  summary_.frames += std::ssize(detections.frames);
  for (const auto& frame : detections.frames) summary_.detections += std::ssize(frame);
  for (const double s : detections.seconds) summary_.seconds += s;
}

void DetectorResults::add_broken(const std::string& sequence,
                                 const std::string& fault,
                                 const std::string& log) {
  write_log(sequence, log + "airtruth: the detector " + fault + "\n");
  const std::lock_guard lock(mutex_);
  ++summary_.broken;
  airtruth::warn(options_.warn,
                 fmt::format("{} on {}: the detector {}", detector_.name, sequence, fault));
}

void DetectorResults::finish(std::span<const results::ExpectedSequence> set,
                             const std::string& file_name) const {
  const bool is_whole =
      std::all_of(set.begin(), set.end(), [&](const results::ExpectedSequence& one) {
        return results::has_sequence(summary_.folder, one.name);
      });
  const fs::path file = summary_.folder / file_name;
  if (!is_whole || (fs::exists(file) && summary_.made == 0)) return;
  results::write_coco_results(file, summary_.folder, set);
}

void DetectorResults::write_log(const std::string& sequence, const std::string& log) const {
  if (log.empty()) return;
  fs::create_directories(summary_.folder / "logs");
  write_file(summary_.folder / "logs" / (sequence + ".log"), log);
}

}  // namespace airtruth::runs
