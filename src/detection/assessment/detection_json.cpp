// SPDX-License-Identifier: Apache-2.0
#include "detection/assessment/detection_json.h"

#include <nlohmann/json.hpp>

#include "detection/assessment/measure_json.h"
#include "detection/assessment/or_null.h"
#include "detection/assessment/track_json.h"

namespace airtruth::detection {
namespace {

using Json = nlohmann::ordered_json;

Json json_of(const FalseAlarm& alarm, const DetectorScore& detector, const Assessment& assessment) {
  const ScoredDetections& scored = detector.sequences[alarm.sequence];
  const TruthSequence& truth = assessment.truths[scored.truth];
  const Box& box = scored.detections.frames[alarm.frame][alarm.detection].box_px;
  return {{"sequence", truth.name},
          {"frame", truth.frames[alarm.frame].frame},
          {"score", alarm.score},
          {"box_px", {box.x, box.y, box.width, box.height}},
          {"what", alarm.what},
          {"frames", alarm.frames},
          {"sequences", alarm.sequences},
          {"to_aircraft_px", or_null(alarm.to_aircraft_px)}};
}

Json json_of(const Miss& miss, const DetectorScore& detector, const Assessment& assessment) {
  const TruthSequence& truth = assessment.truths[detector.sequences[miss.sequence].truth];
  const TruthObject& object = truth.frames[miss.frame].objects[miss.index];
  const Box& box = object.box_px;
  return {{"sequence", truth.name},
          {"object", miss.object},
          {"first_frame", truth.frames[miss.first_frame].frame},
          {"frames", miss.frames},
          {"frame", truth.frames[miss.frame].frame},
          {"box_px", {box.x, box.y, box.width, box.height}},
          {"range_m", or_null(object.range_m)},
          {"contrast_to_noise", or_null(miss.contrast_to_noise)}};
}

}  // namespace

Json json_of(const DetectorScore& detector, const Assessment& assessment) {
  const bool has_hours = detector.froc.hours > 0;
  const auto aot = [&](const std::optional<AotScore>& score) {
    return score ? json_of(*score, has_hours) : Json();
  };
  Json json = {{"name", detector.name},
               {"sequences", detector.sequences.size()},
               {"detections", detector.detections},
               {"frames_per_second_median", or_null(detector.frames_per_second_median)},
               {"average_precision", json_of(detector.average_precision)},
               {"froc", json_of(detector.froc)},
               {"point", detector.point ? json_of(*detector.point, has_hours) : Json()},
               {"by", Json::object()},
               {"false_alarms_by", detector.false_alarms_by},
               {"mistaken_by", Json::object()},
               {"bearing", json_of(detector.bearing)},
               {"aot", json_of(detector.aot, has_hours)},
               {"aot_at_hfar_0.5", has_hours ? aot(detector.aot_ranks.by_hfar) : Json()},
               {"aot_at_fppi_0.0005", aot(detector.aot_ranks.by_fppi)},
               {"tracks", tracks_json_of(detector, assessment)},
               {"strongest_false_alarms", Json::array()},
               {"misses", Json::array()}};
  if (detector.point && detector.weighted_detection)
    json["point"]["weighted_detection"] = json_of(*detector.weighted_detection);
  for (const auto& [key, bins] : detector.by) {
    json["by"][key] = Json::array();
    for (const DetectionBin& bin : bins) json["by"][key].push_back(json_of(bin));
  }
  for (const auto& [what, share] : detector.mistaken_by) json["mistaken_by"][what] = json_of(share);
  for (const FalseAlarm& alarm : detector.false_alarms)
    json["strongest_false_alarms"].push_back(json_of(alarm, detector, assessment));
  for (const Miss& miss : detector.misses)
    json["misses"].push_back(json_of(miss, detector, assessment));
  return json;
}

}  // namespace airtruth::detection
