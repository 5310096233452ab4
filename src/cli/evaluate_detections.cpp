// SPDX-License-Identifier: Apache-2.0
#include "cli/evaluate_detections.h"

#include <fmt/format.h>

namespace airtruth::cli {

std::string number(const std::optional<double>& value, int digits) {
  return value ? fmt::format("{:.{}f}", *value, digits) : "-";
}

namespace {

std::string between(double low, double high) { return fmt::format("{:.3f} to {:.3f}", low, high); }

std::string interval(const std::optional<evaluation::Interval>& found) {
  return found ? between(found->low, found->high) : "-";
}

std::string row(const std::string& name,
                const std::string& sequences,
                const std::string& ap_centre,
                const std::string& ap_interval,
                const std::string& ap_50,
                const std::string& ap,
                const std::string& score,
                const std::string& detection,
                const std::string& detection_interval,
                const std::string& per_image,
                const std::string& per_hour) {
  return fmt::format("{:<20} {:>9} {:>9} {:>15} {:>6} {:>6} {:>9} {:>6} {:>15} {:>9} {:>9}",
                     name,
                     sequences,
                     ap_centre,
                     ap_interval,
                     ap_50,
                     ap,
                     score,
                     detection,
                     detection_interval,
                     per_image,
                     per_hour);
}

std::string row_of(const scores::DetectorScore& detector) {
  const measures::AveragePrecision& ap = detector.average_precision;
  const bool has_point = detector.point.has_value();
  const measures::FrocPoint point = detector.point.value_or(measures::FrocPoint{});
  const bool has_trials = has_point && point.detection.trials > 0;
  return row(detector.name,
             std::to_string(detector.sequences.size()),
             number(ap.ap_centre, 3),
             interval(ap.ap_centre_interval),
             number(ap.ap_50, 3),
             number(ap.ap, 3),
             has_point ? fmt::format("{:.4g}", point.score) : "-",
             has_trials ? fmt::format("{:.3f}", point.detection.value) : "-",
             has_trials ? between(point.detection.low, point.detection.high) : "-",
             has_point ? fmt::format("{:.3g}", point.false_alarms_per_image) : "-",
             has_point && detector.froc.hours > 0
                 ? fmt::format("{:.0f}", point.false_alarms_per_hour)
                 : "-");
}

std::string share_of(const statistics::Proportion& share) {
  return fmt::format("{:.3f} ({})", share.value, between(share.low, share.high));
}

void print_declarations(const char* kind,
                        const std::string& name,
                        const scores::DeclarationSummary& summary,
                        const scores::Assessment& assessment,
                        Console& console) {
  if (!(summary.declared.trials > 0)) return;
  std::string line =
      fmt::format("{}: {} {} of its encounters", name, kind, share_of(summary.declared));
  if (summary.range_m) line += fmt::format(", at {:.0f} m in the mean", summary.range_m->mean);
  if (summary.to_closest_approach_s)
    line += fmt::format(", {:.1f} s before the closest approach in the mean",
                        summary.to_closest_approach_s->mean);
  if (summary.in_time)
    line += fmt::format("; {:g} s before {}: {} of those in {} sequences",
                        assessment.manoeuvre_s.value_or(0),
                        assessment.volume,
                        share_of(*summary.in_time),
                        summary.in_time->clusters);
  if (summary.impossible > 0)
    line += fmt::format("; {} clips begin too late for it", summary.impossible);
  if (summary.no_violation > 0)
    line += fmt::format("; {} never violate {}", summary.no_violation, assessment.volume);
  console.result(line);
}

void print_weighted(const scores::DetectorScore& detector, Console& console) {
  if (!detector.weighted_detection || !(detector.weighted_detection->trials > 0)) return;
  console.result(
      fmt::format("{}: weighted, finds {} of the aircraft in frames; its {} sequences "
                  "are worth {:.1f} of equal weight",
                  detector.name,
                  share_of(*detector.weighted_detection),
                  detector.weighted_detection->clusters,
                  detector.weighted_detection->effective_clusters));
}

void print_tracks(const scores::DetectorScore& detector,
                  const scores::Assessment& assessment,
                  Console& console) {
  if (!detector.tracks) return;
  const scores::TrackScores& tracks = *detector.tracks;
  console.result(fmt::format("{}: HOTA {:.3f}, MOTA {:.3f}, IDF1 {:.3f}, {} false tracks{}",
                             detector.name,
                             measures::Hota::mean(tracks.hota.hota),
                             tracks.clear.mota(),
                             tracks.identity.idf1(),
                             tracks.false_tracks,
                             detector.froc.hours > 0
                                 ? fmt::format(" ({:.1f} an hour)", tracks.false_tracks_per_hour)
                                 : ""));
  print_declarations("declares", detector.name, tracks.declarations, assessment, console);
  if (tracks.weighted_declarations)
    print_declarations(
        "weighted, declares", detector.name, *tracks.weighted_declarations, assessment, console);
}

void print_false_alarms(const scores::DetectorScore& detector, Console& console) {
  if (detector.false_alarms_by.empty()) return;
  std::string line;
  for (const auto& [what, count] : detector.false_alarms_by)
    line += fmt::format("{}{} {}", line.empty() ? "" : ", ", what, count);
  console.result(detector.name + ": false alarms on " + line);
}

}  // namespace

void add_detection_options(CLI::App& command, EvaluateDetections& arguments) {
  detector_evaluation::AssessOptions& options = arguments.options;
  const auto group = "Detectors' results";
  command
      .add_option("--centre-px",
                  options.centre_px,
                  "A detection finds an aircraft where their centres are this near, or half of the "
                  "aircraft's longer side (default: 10)")
      ->check(CLI::Range(0.1, 1000.0))
      ->group(group);
  command
      .add_option("--score",
                  options.point.score,
                  "Detections with this score or more count at the operating point")
      ->group(group);
  command
      .add_option("--false-alarms",
                  options.point.false_alarms_per_image,
                  "Otherwise the least score with so many false alarms an image at most (default: "
                  "0.1)")
      ->check(CLI::Range(0.0, 1e6))
      ->group(group);
  command
      .add_option(
          "--volume",
          options.volume,
          "Volume to keep clear of: f3442, do365-non-cooperative and others, or the scenes' "
          "own")
      ->group(group);
  command
      .add_option("--manoeuvre-s",
                  options.manoeuvre_s,
                  "Which encounters are declared this long before the volume is violated, s")
      ->check(CLI::Range(0.0, 3600.0))
      ->group(group);
  command
      .add_option("--ignore",
                  arguments.ignore,
                  "CSV of regions that count neither way (default: DIR/ignore.csv)")
      ->check(CLI::ExistingFile)
      ->group(group);
  command
      .add_flag("--detections",
                arguments.is_detections,
                "MOTChallenge text with tracks is a detector's, not a tracker's")
      ->group(group);
}

void print_detections(const scores::Assessment& assessment, Console& console) {
  console.result(row("detector",
                     "sequences",
                     fmt::format("AP@{:g}px", assessment.centre_px),
                     "95 %",
                     "AP50",
                     "AP",
                     "score",
                     "PD",
                     "95 %",
                     "FA/image",
                     "FA/hour"));
  for (const scores::DetectorScore& detector : assessment.detectors)
    console.result(row_of(detector));
  for (const scores::DetectorScore& detector : assessment.detectors) {
    print_false_alarms(detector, console);
    print_weighted(detector, console);
    print_tracks(detector, assessment, console);
  }
}

}  // namespace airtruth::cli
