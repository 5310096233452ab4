// SPDX-License-Identifier: Apache-2.0
#include "evaluation/detector_evaluation/tables.h"

#include <algorithm>
#include <optional>
#include <utility>

#include <airtruth/version.h>

#include "evaluation/report/tables.h"

namespace airtruth::detector_evaluation {
namespace {

using report::Json;
using report::json_of;
using report::list_of;

Json json_of(const std::optional<evaluation::PrecisionCurve>& curve,
             const std::optional<evaluation::PrecisionBand>& band) {
  if (!curve) return {};
  Json json = {{"precision", curve->precision},
               {"score", curve->score},
               {"recall", curve->recall},
               {"truths", curve->truths}};
  if (band) {
    json["low_95"] = band->low;
    json["high_95"] = band->high;
  }
  return json;
}

Json json_of(const measures::Spread& spread) {
  return {{"mean", spread.mean},
          {"deviation", spread.deviation},
          {"rms", spread.rms},
          {"within_95", spread.within_95},
          {"count", spread.count},
          {"mean_interval_95", json_of(spread.mean_interval)},
          {"deviation_interval_95", json_of(spread.deviation_interval)},
          {"rms_interval_95", json_of(spread.rms_interval)},
          {"within_95_interval_95", json_of(spread.within_95_interval)}};
}

Json json_of(const evaluation::AotRate& rate) {
  return {{"rate", rate.total > 0 ? Json(rate.rate()) : Json()},
          {"detected", rate.detected},
          {"total", rate.total}};
}

// Null without a trial.
Json json_of(const statistics::Proportion& share) {
  if (!(share.trials > 0)) return {};
  return {{"share", share.value},
          {"interval_95", {share.low, share.high}},
          {"successes", share.successes},
          {"trials", share.trials},
          {"sequences", share.clusters},
          {"effective_sequences", share.effective_clusters}};
}

Json json_of(const std::optional<scores::WeightedMean>& mean) {
  if (!mean) return {};
  return {{"mean", mean->mean}, {"interval_95", json_of(mean->interval)}, {"count", mean->count}};
}

Json json_of(const evaluation::AveragePrecision& ap) {
  return {{"ap", or_null(ap.ap)},
          {"ap_50", or_null(ap.ap_50)},
          {"ap_50_interval_95", json_of(ap.ap_50_interval)},
          {"ap_75", or_null(ap.ap_75)},
          {"ap_small", or_null(ap.ap_small)},
          {"ap_medium", or_null(ap.ap_medium)},
          {"ap_large", or_null(ap.ap_large)},
          {"ar_1", or_null(ap.ar_1)},
          {"ar_10", or_null(ap.ar_10)},
          {"ar_100", or_null(ap.ar_100)},
          {"ar_small", or_null(ap.ar_small)},
          {"ar_medium", or_null(ap.ar_medium)},
          {"ar_large", or_null(ap.ar_large)},
          {"ap_centre", or_null(ap.ap_centre)},
          {"ap_centre_interval_95", json_of(ap.ap_centre_interval)},
          {"curve_50", json_of(ap.curve_50, ap.band_50)},
          {"curve_centre", json_of(ap.curve_centre, ap.band_centre)}};
}

// `has_hours`: false where the duration of the sequences is unknown.
Json json_of(const evaluation::FrocPoint& point, bool has_hours) {
  return {{"score", point.score},
          {"detection", json_of(point.detection)},
          {"false_alarms_per_image", point.false_alarms_per_image},
          {"false_alarms_per_hour", has_hours ? Json(point.false_alarms_per_hour) : Json()},
          {"false_alarms_per_flight", point.false_alarms_per_flight}};
}

Json json_of(const evaluation::Froc& froc) {
  const auto point = [&](const auto& one) { return json_of(one, froc.hours > 0); };
  return {{"images", froc.images},
          {"flights", froc.flights},
          {"hours", froc.hours > 0 ? Json(froc.hours) : Json()},
          {"aircraft_in_images", froc.aircraft},
          {"points", list_of(froc.points, point)}};
}

Json json_of(const scores::DetectionBin& bin) {
  Json json = Json::object();
  if (bin.place.name.empty()) {
    json["from"] = bin.place.from;
    json["to"] = bin.place.to;  // of the last one: infinity, which is written as null
  } else {
    json["name"] = bin.place.name;
  }
  json.update(json_of(bin.detection));
  json["weighted"] = bin.weighted ? json_of(*bin.weighted) : Json();
  return json;
}

Json json_of(const std::optional<measures::BearingError>& error) {
  if (!error) return {};
  const auto rate = [](const std::optional<measures::Spread>& spread) {
    return spread ? json_of(*spread) : Json();
  };
  return {{"azimuth_mrad", json_of(error->azimuth)},
          {"elevation_mrad", json_of(error->elevation)},
          {"azimuth_rate_mradps", rate(error->azimuth_rate)},
          {"elevation_rate_mradps", rate(error->elevation_rate)},
          {"sc228_bearing_deviation_mrad", measures::kSc228Bearing_mrad},
          {"sc228_rate_deviation_mradps", measures::kSc228Rate_mradps}};
}

Json json_of(const evaluation::AotScore& aot, bool has_hours) {
  return {{"score", aot.score},
          {"edr", json_of(aot.edr_all)},
          {"edr_below_horizon", json_of(aot.edr_below)},
          {"edr_mixed", json_of(aot.edr_mixed)},
          {"edr_above_horizon", json_of(aot.edr_above)},
          {"edr_by_frames", json_of(aot.edr_frames_all)},
          {"afdr", json_of(aot.afdr)},
          {"max_range_m", or_null(aot.max_range_m)},
          {"hfar", has_hours ? Json(aot.hfar) : Json()},
          {"fppi", aot.fppi}};
}

Json json_of(const evaluation::Hota& hota) {
  const auto curve = [](const evaluation::Hota::Curve& values) {
    return Json{{"mean", evaluation::Hota::mean(values)}, {"at_overlaps", values}};
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

Json json_of(const evaluation::ClearMot& clear) {
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

Json json_of(const evaluation::Identity& identity) {
  return {{"idf1", identity.idf1()},
          {"recall", identity.recall()},
          {"precision", identity.precision()},
          {"true_positives", identity.true_positives},
          {"false_negatives", identity.false_negatives},
          {"false_positives", identity.false_positives}};
}

Json json_of(const scores::DeclarationSummary& summary) {
  return {{"declared", json_of(summary.declared)},
          {"range_m", json_of(summary.range_m)},
          {"to_closest_approach_s", json_of(summary.to_closest_approach_s)},
          {"in_time", summary.in_time ? json_of(*summary.in_time) : Json()},
          {"no_violation", summary.no_violation},
          {"impossible", summary.impossible},
          {"unknown", summary.unknown}};
}

Json json_of(const scores::EncounterScore& one,
             const scores::DetectorScore& detector,
             const scores::Assessment& assessment) {
  const scores::TruthSequence& truth = assessment.truths[detector.sequences[one.sequence].truth];
  const scores::TruthEncounter* encounter = truth.encounter(one.object);
  Json json = {{"sequence", truth.name},
               {"object", one.object},
               {"name", encounter != nullptr ? Json(encounter->name) : Json()},
               {"weight", truth.weight.value_or(1)},
               {"first_seen_frame", truth.frames[one.first_seen].frame},
               {"first_seen_s", truth.frames[one.first_seen].time_s},
               {"first_seen_range_m", or_null(one.first_seen_range_m)},
               {"frames_seen", one.frames_seen},
               {"least_range_m", or_null(one.least_range_m)},
               {"declaration", Json()},
               {"in_time", enum_name(one.in_time)}};
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

Json json_of(const scores::OperatingPoint& point, bool has_hours) {
  return {{"score", point.score},
          {"false_tracks_per_hour", has_hours ? Json(point.false_tracks_per_hour) : Json()},
          {"declared", json_of(point.declared)},
          {"range_m", json_of(point.range_m)},
          {"range_all_m", json_of(point.range_all_m)}};
}

// Null for results without tracks.
Json tracks_json_of(const scores::DetectorScore& detector, const scores::Assessment& assessment) {
  if (!detector.tracks) return {};
  const scores::TrackScores& tracks = *detector.tracks;
  const bool has_hours = detector.froc.hours > 0;
  const auto encounter = [&](const auto& one) { return json_of(one, detector, assessment); };
  const auto point = [&](const auto& one) { return json_of(one, has_hours); };
  return {{"hota", json_of(tracks.hota)},
          {"clear", json_of(tracks.clear)},
          {"identity", json_of(tracks.identity)},
          {"false_tracks", tracks.false_tracks},
          {"false_tracks_per_hour", has_hours ? Json(tracks.false_tracks_per_hour) : Json()},
          {"declarations", json_of(tracks.declarations)},
          {"weighted_declarations",
           tracks.weighted_declarations ? json_of(*tracks.weighted_declarations) : Json()},
          {"encounters", list_of(tracks.encounters, encounter)},
          {"operating_curve", list_of(tracks.operating_curve, point)}};
}

Json json_of(const scores::FalseAlarm& alarm,
             const scores::DetectorScore& detector,
             const scores::Assessment& assessment) {
  const scores::TruthSequence& truth = assessment.truths[detector.sequences[alarm.sequence].truth];
  const Box& box = alarm.box_px;
  return {{"sequence", truth.name},
          {"frame", truth.frames[alarm.frame].frame},
          {"score", alarm.score},
          {"box_px", {box.x, box.y, box.width, box.height}},
          {"what", alarm.what},
          {"frames", alarm.frames},
          {"sequences", alarm.sequences},
          {"to_aircraft_px", or_null(alarm.to_aircraft_px)}};
}

Json json_of(const scores::Miss& miss,
             const scores::DetectorScore& detector,
             const scores::Assessment& assessment) {
  const scores::TruthSequence& truth = assessment.truths[detector.sequences[miss.sequence].truth];
  const Box& box = miss.box_px;
  return {{"sequence", truth.name},
          {"object", miss.object},
          {"first_frame", truth.frames[miss.first_frame].frame},
          {"frames", miss.frames},
          {"frame", truth.frames[miss.frame].frame},
          {"box_px", {box.x, box.y, box.width, box.height}},
          {"range_m", or_null(miss.range_m)},
          {"contrast_to_noise", or_null(miss.contrast_to_noise)}};
}

}  // namespace

Json json_of_detector(const scores::DetectorScore& detector, const scores::Assessment& assessment) {
  const bool has_hours = detector.froc.hours > 0;
  const auto aot = [&](const std::optional<evaluation::AotScore>& score) {
    return score ? json_of(*score, has_hours) : Json();
  };
  const auto entry = [&](const auto& one) { return json_of(one, detector, assessment); };
  Json json = {{"name", detector.name},
               {"sequences", detector.sequences.size()},
               {"detections", detector.detections},
               {"frames_per_second_median", or_null(detector.frames_per_second_median)},
               {"average_precision", json_of(detector.average_precision)},
               {"froc", json_of(detector.froc)},
               {"point", json_of(detector.point, has_hours)},
               {"by", Json::object()},
               {"false_alarms_by", detector.false_alarms_by},
               {"mistaken_by", Json::object()},
               {"bearing", json_of(detector.bearing)},
               {"aot", json_of(detector.aot, has_hours)},
               {"aot_at_hfar_0.5", has_hours ? aot(detector.aot_ranks.by_hfar) : Json()},
               {"aot_at_fppi_0.0005", aot(detector.aot_ranks.by_fppi)},
               {"tracks", tracks_json_of(detector, assessment)},
               {"strongest_false_alarms", list_of(detector.false_alarms, entry)},
               {"misses", list_of(detector.misses, entry)}};
  json["point"]["weighted_detection"] =
      detector.weighted_detection ? json_of(*detector.weighted_detection) : Json();
  for (const auto& [key, bins] : detector.by)
    json["by"][key] = list_of(bins, [](const auto& bin) { return json_of(bin); });
  for (const auto& [what, share] : detector.mistaken_by) json["mistaken_by"][what] = json_of(share);
  return json;
}

namespace {

constexpr const char* kFormat = "airtruth detection evaluation 1";

// The format of numbers in CSV.
constexpr const char* kNumber = "{:.9g}";

constexpr const char* kDetectorColumns =
    "detector=name,sequences,detections,ap=average_precision/ap,ap_50=average_precision/ap_50,"
    "ap_50_*_95=average_precision/ap_50_interval_95,ap_75=average_precision/ap_75,"
    "ap_centre=average_precision/ap_centre,"
    "ap_centre_*_95=average_precision/ap_centre_interval_95,"
    "point_score=point/score,detection=point/detection/share,"
    "detection_*_95=point/detection/interval_95,"
    "weighted_detection=point/weighted_detection/share,"
    "weighted_detection_*_95=point/weighted_detection/interval_95,"
    "false_alarms_per_image=point/false_alarms_per_image,"
    "false_alarms_per_hour=point/false_alarms_per_hour,"
    "false_alarms_per_flight=point/false_alarms_per_flight,"
    "azimuth_deviation_mrad=bearing/azimuth_mrad/deviation,"
    "azimuth_deviation_*_95_mrad=bearing/azimuth_mrad/deviation_interval_95,"
    "elevation_deviation_mrad=bearing/elevation_mrad/deviation,"
    "elevation_deviation_*_95_mrad=bearing/elevation_mrad/deviation_interval_95,"
    "azimuth_rate_deviation_mradps=bearing/azimuth_rate_mradps/deviation,"
    "azimuth_rate_deviation_*_95_mradps=bearing/azimuth_rate_mradps/deviation_interval_95,"
    "elevation_rate_deviation_mradps=bearing/elevation_rate_mradps/deviation,"
    "elevation_rate_deviation_*_95_mradps=bearing/elevation_rate_mradps/deviation_interval_95,"
    "aot_edr=aot/edr/rate,aot_hfar=aot/hfar,aot_afdr=aot/afdr/rate,aot_fppi=aot/fppi,"
    "hota=tracks/hota/hota/mean,mota=tracks/clear/mota,idf1=tracks/identity/idf1,"
    "declared=tracks/declarations/declared/share,"
    "declared_*_95=tracks/declarations/declared/interval_95,"
    "declaration_range_m=tracks/declarations/range_m/mean,"
    "declaration_range_*_95=tracks/declarations/range_m/interval_95,"
    "declaration_to_closest_approach_s=tracks/declarations/to_closest_approach_s/mean,"
    "declaration_to_closest_approach_*_95=tracks/declarations/to_closest_approach_s/interval_95,"
    "in_time=tracks/declarations/in_time/share,"
    "in_time_*_95=tracks/declarations/in_time/interval_95,"
    "false_tracks_per_hour=tracks/false_tracks_per_hour,frames_per_second_median";

std::string sequences_csv(const scores::Assessment& assessment) {
  std::vector<Json> rows;
  for (const scores::DetectorScore& detector : assessment.detectors)
    for (const scores::ScoredDetections& scored : detector.sequences) {
      const scores::TruthSequence& truth = assessment.truths[scored.truth];
      const auto of_point = [&](const auto& one) { return one >= detector.point.score; };
      const evaluation::FrocSequence counted = scores::froc_sequence_of(truth, scored);
      rows.push_back(
          {{"detector", detector.name},
           {"sequence", truth.name},
           {"background", truth.background},
           {"frames", truth.frames.size()},
           {"duration_s", truth.duration_s > 0 ? Json(truth.duration_s) : Json()},
           {"weight", truth.weight.value_or(1)},
           {"aircraft_in_frames", counted.best_scores.size()},
           {"found", std::ranges::count_if(counted.best_scores, of_point)},
           {"false_alarms", std::ranges::count_if(counted.false_alarm_scores, of_point)}});
    }
  return report::csv_of(
      "detector,sequence,background,frames,duration_s,weight,aircraft_in_frames,found,false_alarms",
      rows,
      kNumber);
}

// The tables below state what the JSON of the detectors does.
using Detectors = std::vector<Json>;

std::string encounters_csv(const Detectors& detectors) {
  std::vector<Json> rows;
  for (const Json& detector : detectors) {
    if (detector["tracks"].is_null()) continue;
    for (const Json& encounter : detector["tracks"]["encounters"]) {
      Json& row = rows.emplace_back(encounter);
      row["detector"] = detector["name"];
      if (row["in_time"] == enum_name(scores::InTime::kUnknown)) row["in_time"] = "";
    }
  }
  return report::csv_of(
      "detector,sequence,object,weight,first_seen_s,first_seen_range_m,"
      "declared_s=declaration/time_s,declared_range_m=declaration/range_m,"
      "declared_to_closest_approach_s=declaration/to_closest_approach_s,violation_s,in_time",
      rows,
      kNumber);
}

std::string breakdown_csv(const Detectors& detectors) {
  std::vector<Json> rows;
  for (const Json& detector : detectors)
    for (const auto& [key, bins] : detector["by"].items())
      for (const Json& bin : bins) {
        Json& row = rows.emplace_back(bin);
        row["detector"] = detector["name"];
        row["by"] = key;
      }
  return report::csv_of(
      "detector,by,name,from,to,aircraft_in_frames=trials,found=successes,detection=share,"
      "*_95=interval_95,weighted_detection=weighted/share,weighted_*_95=weighted/interval_95,"
      "effective_sequences=weighted/effective_sequences",
      rows,
      kNumber);
}

// One row for each recall.
Json recalls_of(const Json& curve) {
  Json rows = Json::array();
  for (std::size_t i = 0; !curve.is_null() && i < curve["score"].size(); ++i) {
    Json& row = rows.emplace_back();
    row["recall"] = static_cast<double>(i) / (evaluation::kRecallSteps - 1);
    for (const char* key : {"score", "precision", "low_95", "high_95"})
      if (curve.contains(key)) row[key] = curve[key][i];
  }
  return rows;
}

std::string curves_csv(const Detectors& detectors) {
  std::string text = report::csv_of("detector,curve,score,x,y,*_95", {}, kNumber);
  for (const Json& detector : detectors) {
    const auto add = [&](const char* curve, const Json& points, const char* xy) {
      std::vector<Json> rows(points.begin(), points.end());
      for (Json& row : rows) row.update({{"detector", detector["name"]}, {"curve", curve}});
      text += report::csv_rows(std::string("detector,curve,score,") + xy, rows, kNumber);
    };
    const Json& precision = detector["average_precision"];
    for (const auto& [name, key] : {std::pair{"precision_by_recall_overlap_50", "curve_50"},
                                    {"precision_by_recall_centre", "curve_centre"}})
      add(name, recalls_of(precision[key]), "recall,precision,low_95,high_95");
    add("detection_by_false_alarms_per_image",
        detector["froc"]["points"],
        "false_alarms_per_image,detection/share,*=detection/interval_95");
    if (detector["tracks"].is_null() || detector["froc"]["hours"].is_null()) continue;
    Json declared = detector["tracks"]["operating_curve"];
    std::erase_if(declared.get_ref<Json::array_t&>(),
                  [](const Json& point) { return point["range_m"].is_null(); });
    add("declaration_range_by_false_tracks_per_hour",
        declared,
        "false_tracks_per_hour,range_m/mean,*=range_m/interval_95");
  }
  return text;
}

Json point_options_of(const scores::Assessment& assessment) {
  Json json = {{"centre_px", assessment.options.centre_px}};
  if (assessment.options.score)
    json["score"] = *assessment.options.score;
  else
    json["false_alarms_per_image"] = assessment.options.false_alarms_per_image;
  return json;
}

}  // namespace

void write_tables(const scores::Assessment& assessment, const std::filesystem::path& out) {
  Detectors detectors;
  for (const scores::DetectorScore& detector : assessment.detectors)
    detectors.push_back(json_of_detector(detector, assessment));
  Json all = {
      {"format", kFormat},
      {"version", kVersion},
      {"dataset", assessment.set},
      {"options", point_options_of(assessment)},
      {"manoeuvre_s", or_null(assessment.options.manoeuvre_s)},
      {"volume", assessment.options.volume.empty() ? Json() : Json(assessment.options.volume)},
      {"weighted", assessment.options.is_weighted},
      {"where", assessment.where},
      {"left_out", assessment.left_out},
      {"detectors", detectors}};
  report::write_files(out,
                      {{"detectors.csv", report::csv_of(kDetectorColumns, detectors, kNumber)},
                       {"detection_sequences.csv", sequences_csv(assessment)},
                       {"detection_encounters.csv", encounters_csv(detectors)},
                       {"detection_breakdown.csv", breakdown_csv(detectors)},
                       {"detection_curves.csv", curves_csv(detectors)},
                       {"detection.json", all.dump(1) + "\n"}});
}

}  // namespace airtruth::detector_evaluation
