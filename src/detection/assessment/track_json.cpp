// SPDX-License-Identifier: Apache-2.0
#include "detection/assessment/track_json.h"

#include <nlohmann/json.hpp>

#include "detection/assessment/measure_json.h"
#include "detection/assessment/or_null.h"

namespace airtruth::detection {
namespace {

using Json = nlohmann::ordered_json;

Json json_of(const Hota& hota) {
  const auto curve = [](const Hota::Curve& values) {
    return Json{{"mean", Hota::mean(values)}, {"at_overlaps", values}};
  };
  return {{"hota", curve(hota.hota)},
          {"det_a", curve(hota.det_a)},
          {"ass_a", curve(hota.ass_a)},
          {"det_re", curve(hota.det_re)},
          {"det_pr", curve(hota.det_pr)},
          {"ass_re", curve(hota.ass_re)},
          {"ass_pr", curve(hota.ass_pr)},
          {"loc_a", curve(hota.loc_a)}};
}

Json json_of(const ClearMot& clear) {
  return {{"mota", clear.mota()},
          {"motp", clear.motp()},
          {"recall", clear.recall()},
          {"precision", clear.precision()},
          {"true_positives", clear.true_positives},
          {"false_negatives", clear.false_negatives},
          {"false_positives", clear.false_positives},
          {"identity_switches", clear.identity_switches},
          {"fragmentations", clear.fragmentations},
          {"mostly_tracked", clear.mostly_tracked},
          {"partly_tracked", clear.partly_tracked},
          {"mostly_lost", clear.mostly_lost}};
}

Json json_of(const Identity& identity) {
  return {{"idf1", identity.idf1()},
          {"recall", identity.recall()},
          {"precision", identity.precision()},
          {"true_positives", identity.true_positives},
          {"false_negatives", identity.false_negatives},
          {"false_positives", identity.false_positives}};
}

Json json_of(const DeclarationSummary& summary) {
  return {{"declared", json_of(summary.declared)},
          {"range_m", json_of(summary.range_m)},
          {"to_closest_approach_s", json_of(summary.to_closest_approach_s)},
          {"in_time", summary.in_time ? json_of(*summary.in_time) : Json()},
          {"no_violation", summary.no_violation},
          {"impossible", summary.impossible},
          {"unknown", summary.unknown}};
}

const char* name(InTime in_time) {
  switch (in_time) {
    case InTime::kUnknown:
      return "unknown";
    case InTime::kNoViolation:
      return "no violation";
    case InTime::kImpossible:
      return "impossible";
    case InTime::kYes:
      return "yes";
    case InTime::kNo:
      return "no";
  }
  return "unknown";
}

Json json_of(const EncounterScore& one,
             const DetectorScore& detector,
             const Assessment& assessment) {
  const TruthSequence& truth = assessment.truths[detector.sequences[one.sequence].truth];
  const TruthEncounter* encounter = truth.encounter(one.object);
  Json json = {{"sequence", truth.name},
               {"object", one.object},
               {"name", encounter != nullptr ? Json(encounter->name) : Json()},
               {"weight", truth.weight},
               {"first_seen_frame", truth.frames[one.first_seen].frame},
               {"first_seen_s", truth.frames[one.first_seen].time_s},
               {"first_seen_range_m", or_null(one.first_seen_range_m)},
               {"frames_seen", one.frames_seen},
               {"least_range_m", or_null(one.least_range_m)},
               {"declaration", Json()},
               {"in_time", name(one.in_time)}};
  if (encounter != nullptr) {
    json["closest_approach_s"] = or_null(encounter->closest_approach_s);
    json["violation_s"] = or_null(encounter->violation_s);
  }
  if (one.declaration)
    json["declaration"] = {
        {"frame", truth.frames[one.declaration->frame].frame},
        {"time_s", one.declaration->time_s},
        {"track", one.declaration->track},
        {"range_m", or_null(one.declaration->range_m)},
        {"to_closest_approach_s", or_null(one.declaration->to_closest_approach_s)}};
  return json;
}

Json json_of(const OperatingPoint& point, bool has_hours) {
  return {{"score", point.score},
          {"false_tracks_per_hour", has_hours ? Json(point.false_tracks_per_hour) : Json()},
          {"declared", json_of(point.declared)},
          {"range_m", json_of(point.range_m)},
          {"range_all_m", json_of(point.range_all_m)}};
}

}  // namespace

Json tracks_json_of(const DetectorScore& detector, const Assessment& assessment) {
  if (!detector.tracks) return {};
  const TrackScores& tracks = *detector.tracks;
  const bool has_hours = detector.froc.hours > 0;
  Json json = {{"hota", json_of(tracks.hota)},
               {"clear", json_of(tracks.clear)},
               {"identity", json_of(tracks.identity)},
               {"false_tracks", tracks.false_tracks},
               {"false_tracks_per_hour", has_hours ? Json(tracks.false_tracks_per_hour) : Json()},
               {"declarations", json_of(tracks.declarations)},
               {"weighted_declarations",
                tracks.weighted_declarations ? json_of(*tracks.weighted_declarations) : Json()},
               {"encounters", Json::array()},
               {"operating_curve", Json::array()}};
  for (const EncounterScore& one : tracks.encounters)
    json["encounters"].push_back(json_of(one, detector, assessment));
  for (const OperatingPoint& point : tracks.operating_curve)
    json["operating_curve"].push_back(json_of(point, has_hours));
  return json;
}

}  // namespace airtruth::detection
