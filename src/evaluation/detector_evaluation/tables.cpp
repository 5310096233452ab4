// SPDX-License-Identifier: Apache-2.0
#include "evaluation/detector_evaluation/tables.h"

#include <cmath>
#include <set>

#include <airtruth/version.h>
#include <fmt/format.h>

#include "evaluation/detector_evaluation/json.h"
#include "evaluation/report/tables.h"

namespace airtruth::detector_evaluation {
namespace {

using report::Json;

constexpr const char* kFormat = "airtruth detection evaluation 1";

using report::quoted;

std::string cell(double value) { return fmt::format(",{:.9g}", value); }
std::string cell(const std::optional<double>& value) { return value ? cell(*value) : ","; }
std::string cells(const std::optional<evaluation::Interval>& interval) {
  return interval ? cell(interval->low) + cell(interval->high) : ",,";
}
std::string cells(const std::optional<statistics::Proportion>& share) {
  return share && share->trials > 0 ? cell(share->value) + cell(share->low) + cell(share->high)
                                    : ",,,";
}
std::string cells(const std::optional<scores::WeightedMean>& mean) {
  return mean ? cell(mean->mean) + cells(mean->interval) : ",,,";
}

constexpr const char* kDetectorsHead =
    "detector,sequences,detections,ap,ap_50,ap_50_low_95,ap_50_high_95,ap_75,ap_centre,"
    "ap_centre_low_95,ap_centre_high_95,point_score,detection,detection_low_95,detection_high_95,"
    "weighted_detection,weighted_detection_low_95,weighted_detection_high_95,"
    "false_alarms_per_image,false_alarms_per_hour,false_alarms_per_flight,"
    "azimuth_deviation_mrad,azimuth_deviation_low_95_mrad,azimuth_deviation_high_95_mrad,"
    "elevation_deviation_mrad,elevation_deviation_low_95_mrad,elevation_deviation_high_95_mrad,"
    "azimuth_rate_deviation_mradps,azimuth_rate_deviation_low_95_mradps,"
    "azimuth_rate_deviation_high_95_mradps,elevation_rate_deviation_mradps,"
    "elevation_rate_deviation_low_95_mradps,elevation_rate_deviation_high_95_mradps,aot_edr,"
    "aot_hfar,aot_afdr,aot_fppi,hota,mota,idf1,declared,declared_low_95,declared_high_95,"
    "declaration_range_m,declaration_range_low_95,declaration_range_high_95,"
    "declaration_to_closest_approach_s,declaration_to_closest_approach_low_95,"
    "declaration_to_closest_approach_high_95,in_time,in_time_low_95,in_time_high_95,"
    "false_tracks_per_hour,frames_per_second_median\n";

std::string point_cells(const scores::DetectorScore& detector) {
  if (!detector.point) return std::string(10, ',');
  const measures::FrocPoint& point = *detector.point;
  return cell(point.score) + cells(std::optional(point.detection)) +
         cells(detector.weighted_detection) + cell(point.false_alarms_per_image) +
         (detector.froc.hours > 0 ? cell(point.false_alarms_per_hour) : ",") +
         cell(point.false_alarms_per_flight);
}

std::string bearing_cells(const std::optional<measures::BearingError>& error) {
  if (!error) return std::string(12, ',');
  const auto deviation = [](const std::optional<measures::Spread>& spread) {
    if (!spread) return std::string(3, ',');
    const auto& intervals = spread->intervals;
    return cell(spread->deviation) +
           cells(intervals ? std::optional(intervals->deviation) : std::nullopt);
  };
  return deviation(error->azimuth) + deviation(error->elevation) + deviation(error->azimuth_rate) +
         deviation(error->elevation_rate);
}

std::string aot_cells(const scores::DetectorScore& detector) {
  const measures::AotScore& aot = detector.aot;
  const auto rate = [](const measures::AotRate& one) {
    return one.total > 0 ? cell(one.rate()) : std::string(",");
  };
  return rate(aot.edr_all) + (detector.froc.hours > 0 ? cell(aot.hfar) : ",") + rate(aot.afdr) +
         cell(aot.fppi);
}

std::string track_cells(const scores::DetectorScore& detector) {
  if (!detector.tracks) return std::string(16, ',');
  const scores::TrackScores& tracks = *detector.tracks;
  const scores::DeclarationSummary& declarations = tracks.declarations;
  return cell(measures::Hota::mean(tracks.hota.hota)) + cell(tracks.clear.mota()) +
         cell(tracks.identity.idf1()) + cells(std::optional(declarations.declared)) +
         cells(declarations.range_m) + cells(declarations.to_closest_approach_s) +
         cells(declarations.in_time) +
         (detector.froc.hours > 0 ? cell(tracks.false_tracks_per_hour) : ",");
}

std::string detectors_csv(const scores::Assessment& assessment) {
  std::string text = kDetectorsHead;
  for (const scores::DetectorScore& detector : assessment.detectors) {
    const measures::AveragePrecision& ap = detector.average_precision;
    text += quoted(detector.name) +
            fmt::format(",{},{}", detector.sequences.size(), detector.detections) + cell(ap.ap) +
            cell(ap.ap_50) + cells(ap.ap_50_interval) + cell(ap.ap_75) + cell(ap.ap_centre) +
            cells(ap.ap_centre_interval) + point_cells(detector) + bearing_cells(detector.bearing) +
            aot_cells(detector) + track_cells(detector) + cell(detector.frames_per_second_median) +
            "\n";
  }
  return text;
}

// What one sequence has at the operating point.
struct SequenceCounts {
  std::int64_t aircraft = 0;
  std::int64_t detected = 0;
  std::int64_t false_alarms = 0;
};

SequenceCounts counts_of(const scores::ScoredDetections& scored,
                         const scores::TruthSequence& truth,
                         double score) {
  SequenceCounts counts;
  for (std::size_t i = 0; i < scored.matches.size(); ++i) {
    for (std::size_t k = 0; k < scored.matches[i].size(); ++k)
      counts.false_alarms += scored.matches[i][k].kind == scores::MatchKind::kFalseAlarm &&
                                     scored.detections.frames[i][k].score >= score
                                 ? 1
                                 : 0;
    counts.detected += std::ssize(scores::detected_in(scored, i, score));
    for (const scores::TruthObject& object : truth.frames[i].objects)
      counts.aircraft += object.is_aircraft() && object.counts ? 1 : 0;
  }
  return counts;
}

std::string sequences_csv(const scores::Assessment& assessment) {
  std::string text =
      "detector,sequence,background,frames,duration_s,weight,aircraft_in_frames,found,false_"
      "alarms\n";
  for (const scores::DetectorScore& detector : assessment.detectors)
    for (const scores::ScoredDetections& scored : detector.sequences) {
      const scores::TruthSequence& truth = assessment.truths[scored.truth];
      const double score = detector.point ? detector.point->score : 0;
      const SequenceCounts counts = counts_of(scored, truth, score);
      text += quoted(detector.name) + "," + quoted(truth.name) + "," + quoted(truth.background) +
              fmt::format(",{}", truth.frames.size()) +
              (truth.duration_s > 0 ? cell(truth.duration_s) : ",") + cell(truth.weight) +
              fmt::format(",{},{},{}\n", counts.aircraft, counts.detected, counts.false_alarms);
    }
  return text;
}

std::string encounters_csv(const scores::Assessment& assessment) {
  std::string text =
      "detector,sequence,object,weight,first_seen_s,first_seen_range_m,declared_s,declared_range_m,"
      "declared_to_closest_approach_s,violation_s,in_time\n";
  for (const scores::DetectorScore& detector : assessment.detectors) {
    if (!detector.tracks) continue;
    for (const scores::EncounterScore& one : detector.tracks->encounters) {
      const scores::TruthSequence& truth =
          assessment.truths[detector.sequences[one.sequence].truth];
      const scores::TruthEncounter* encounter = truth.encounter(one.object);
      const auto& declared = one.declaration;
      text += quoted(detector.name) + "," + quoted(truth.name) + fmt::format(",{}", one.object) +
              cell(truth.weight) + cell(truth.frames[one.first_seen].time_s) +
              cell(one.first_seen_range_m) +
              (declared ? cell(declared->time_s) + cell(declared->range_m) +
                              cell(declared->to_closest_approach_s)
                        : ",,,") +
              cell(encounter != nullptr ? encounter->violation_s : std::nullopt) + "," +
              (one.in_time == scores::InTime::kUnknown ? "" : scores::name_of(one.in_time)) + "\n";
    }
  }
  return text;
}

std::string breakdown_csv(const scores::Assessment& assessment) {
  std::string text =
      "detector,by,name,from,to,aircraft_in_frames,found,detection,low_95,high_95,"
      "weighted_detection,weighted_low_95,weighted_high_95,effective_sequences\n";
  for (const scores::DetectorScore& detector : assessment.detectors)
    for (const auto& [key, bins] : detector.by)
      for (const scores::DetectionBin& bin : bins) {
        text += quoted(detector.name) + "," + key + "," + quoted(bin.name);
        text +=
            bin.name.empty() ? cell(bin.from) + (std::isfinite(bin.to) ? cell(bin.to) : ",") : ",,";
        text += cell(bin.detection.trials) + cell(bin.detection.successes) +
                cells(std::optional(bin.detection)) + cells(bin.weighted) +
                (bin.weighted ? cell(bin.weighted->effective_clusters) : ",") + "\n";
      }
  return text;
}

std::string curves_csv(const scores::Assessment& assessment) {
  std::string text = "detector,curve,score,x,y,low_95,high_95\n";
  const auto line =
      [&](const scores::DetectorScore& detector, const char* curve, const std::string& rest) {
        text += quoted(detector.name) + "," + curve + rest + "\n";
      };
  const auto precision = [&](const scores::DetectorScore& detector,
                             const char* name,
                             const std::optional<measures::PrecisionCurve>& curve,
                             const std::optional<measures::PrecisionBand>& band) {
    if (!curve) return;
    for (std::size_t i = 0; i < curve->precision.size(); ++i)
      line(detector,
           name,
           cell(curve->score[i]) + cell(static_cast<double>(i) / 100) + cell(curve->precision[i]) +
               (band ? cell(band->low[i]) + cell(band->high[i]) : ",,"));
  };
  for (const scores::DetectorScore& detector : assessment.detectors) {
    const measures::AveragePrecision& ap = detector.average_precision;
    precision(detector, "precision_by_recall_overlap_50", ap.curve_50, ap.band_50);
    precision(detector, "precision_by_recall_centre", ap.curve_centre, ap.band_centre);
    for (const measures::FrocPoint& point : detector.froc.points)
      line(detector,
           "detection_by_false_alarms_per_image",
           cell(point.score) + cell(point.false_alarms_per_image) +
               cells(std::optional(point.detection)));
    if (!detector.tracks || !(detector.froc.hours > 0)) continue;
    for (const scores::OperatingPoint& point : detector.tracks->operating_curve)
      if (point.range_m)
        line(detector,
             "declaration_range_by_false_tracks_per_hour",
             cell(point.score) + cell(point.false_tracks_per_hour) + cells(point.range_m));
  }
  return text;
}

Json point_options_of(const scores::Assessment& assessment) {
  Json json = {{"centre_px", assessment.centre_px}};
  if (assessment.point.score)
    json["score"] = *assessment.point.score;
  else
    json["false_alarms_per_image"] = assessment.point.false_alarms_per_image;
  return json;
}

}  // namespace

void write_tables(const scores::Assessment& assessment, const std::filesystem::path& out) {
  Json all = {{"format", kFormat},
              {"version", kVersion},
              {"dataset", assessment.set},
              {"options", point_options_of(assessment)},
              {"manoeuvre_s", report::or_null(assessment.manoeuvre_s)},
              {"volume", assessment.volume.empty() ? Json() : Json(assessment.volume)},
              {"weighted", assessment.is_weighted},
              {"left_out", assessment.left_out},
              {"detectors", Json::array()}};
  for (const scores::DetectorScore& detector : assessment.detectors)
    all["detectors"].push_back(json_of_detector(detector, assessment));
  report::write_files(out,
                      {{"detectors.csv", detectors_csv(assessment)},
                       {"detection_sequences.csv", sequences_csv(assessment)},
                       {"detection_encounters.csv", encounters_csv(assessment)},
                       {"detection_breakdown.csv", breakdown_csv(assessment)},
                       {"detection_curves.csv", curves_csv(assessment)},
                       {"detection.json", all.dump(1) + "\n"}});
}

}  // namespace airtruth::detector_evaluation
