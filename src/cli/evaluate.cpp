// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "cli/commands.h"
#include "dataset/sequences/condition.h"
#include "evaluation/detector_evaluation/assess.h"
#include "evaluation/detector_evaluation/page.h"
#include "evaluation/detector_evaluation/tables.h"
#include "evaluation/report/plots.h"
#include "evaluation/tracker_evaluation/assess.h"
#include "evaluation/tracker_evaluation/page.h"
#include "evaluation/tracker_evaluation/tables.h"
#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/run_files/run_files.h"

namespace airtruth::cli {
namespace {

struct Evaluate {
  std::string set;
  std::vector<std::string> results;
  std::string out;
  std::vector<int> eao_range;
  std::string against;
  std::vector<std::string> where;
  bool no_page = false;
  std::string figures;
  tracker_evaluation::AssessOptions options;
  detector_evaluation::AssessOptions detections;
  std::string ignore;
  // MOTChallenge text is a detector's, also where it has tracks.
  bool is_detections = false;
};

// A cell of a table of results, "-" where nothing was measured.
std::string number(const std::optional<double>& value, int digits) {
  return value ? fmt::format("{:.{}f}", *value, digits) : "-";
}

std::string between(double low, double high) { return fmt::format("{:.3f} to {:.3f}", low, high); }

std::string interval(const std::optional<evaluation::Interval>& found) {
  return found ? between(found->low, found->high) : "-";
}

constexpr auto kDetectorLine =
    "{:<20} {:>9} {:>9} {:>15} {:>6} {:>6} {:>9} {:>6} {:>15} {:>9} {:>9}";

std::string row_of(const scores::DetectorScore& detector) {
  const evaluation::AveragePrecision& ap = detector.average_precision;
  const evaluation::FrocPoint& point = detector.point;
  const bool has_trials = point.detection.trials > 0;
  return fmt::format(
      kDetectorLine,
      detector.name,
      detector.sequences.size(),
      number(ap.ap_centre, 3),
      interval(ap.ap_centre_interval),
      number(ap.ap_50, 3),
      number(ap.ap, 3),
      fmt::format("{:.4g}", point.score),
      has_trials ? fmt::format("{:.3f}", point.detection.value) : "-",
      has_trials ? between(point.detection.low, point.detection.high) : "-",
      fmt::format("{:.3g}", point.false_alarms_per_image),
      detector.froc.hours > 0 ? fmt::format("{:.0f}", point.false_alarms_per_hour) : "-");
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
    line += fmt::format(", {:.1f} s {} the closest approach in the mean",
                        std::abs(summary.to_closest_approach_s->mean),
                        summary.to_closest_approach_s->mean < 0 ? "after" : "before");
  if (summary.in_time)
    line += fmt::format("; {:g} s before {}: {} of those in {} sequences",
                        assessment.options.manoeuvre_s.value_or(0),
                        assessment.options.volume,
                        share_of(*summary.in_time),
                        summary.in_time->clusters);
  if (summary.impossible > 0)
    line += fmt::format("; {} clips begin too late for it", summary.impossible);
  if (summary.no_violation > 0)
    line += fmt::format("; {} never violate {}", summary.no_violation, assessment.options.volume);
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
                             evaluation::Hota::mean(tracks.hota.hota),
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

constexpr const char* kOfDetectors = "Detectors' results";

void add_detection_options(CLI::App& command, Evaluate& arguments, Context& context) {
  detector_evaluation::AssessOptions& options = arguments.detections;
  command.add_option("--centre-px", options.centre_px)
      ->description(
          "A detection finds an aircraft where their centres are this near, or half of the "
          "aircraft's longer side (default: 10)")
      ->check(CLI::Range(0.1, 1000.0))
      ->group(kOfDetectors);
  command.add_option("--score", options.score)
      ->description("Detections with this score or more count at the operating point")
      ->group(kOfDetectors);
  command.add_option("--false-alarms", options.false_alarms_per_image)
      ->description(
          "Otherwise the least score with so many false alarms an image at most (default: "
          "0.1)")
      ->check(CLI::Range(0.0, 1e6))
      ->group(kOfDetectors);
  expect_effect(
      context, command, {"--false-alarms"}, "with --score", [&options] { return !options.score; });
  command.add_option("--volume", options.volume)
      ->description(
          "Volume to keep clear of: f3442, do365-non-cooperative and others, or the scenes' "
          "own")
      ->group(kOfDetectors);
  command.add_option("--manoeuvre-s", options.manoeuvre_s)
      ->description("Which encounters are declared this long before the volume is violated, s")
      ->check(CLI::Range(0.0, 3600.0))
      ->group(kOfDetectors);
  command.add_option("--ignore", arguments.ignore)
      ->description("CSV of regions that count neither way (default: DIR/ignore.csv)")
      ->check(CLI::ExistingFile)
      ->group(kOfDetectors);
  command.add_flag("--detections", arguments.is_detections)
      ->description("MOTChallenge text with tracks is a detector's, not a tracker's")
      ->group(kOfDetectors);
}

void print_detections(const scores::Assessment& assessment, Console& console) {
  console.result(fmt::format(kDetectorLine,
                             "detector",
                             "sequences",
                             fmt::format("AP@{:g}px", assessment.options.centre_px),
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

constexpr auto kOnePassLine =
    "{:<20} {:>9} {:>6} {:>15} {:>6} {:>6} {:>6} {:>6} {:>9} {:>7} {:>4} {:>10} {:>10}";

std::string one_pass_line(const tracker_evaluation::ScoredTracker& tracker,
                          const evaluation::Score& s) {
  return fmt::format(kOnePassLine,
                     tracker.name,
                     std::ranges::count_if(tracker.sequences,
                                           [](const auto& one) { return one.score.has_value(); }),
                     number(s.auc, 3),
                     interval(tracker.intervals.at("auc")),
                     number(s.precision_20px, 3),
                     number(s.normalised_auc, 3),
                     number(s.average_overlap, 3),
                     number(s.success_50, 3),
                     number(s.centre_mean_px, 1),
                     number(tracker.angle_mrad, 1),
                     tracker.lost,
                     number(s.frames_per_second, 1),
                     number(s.frames_per_second_median, 1));
}

void print_one_pass(const tracker_evaluation::Assessment& assessment, Console& console) {
  console.result(fmt::format(kOnePassLine,
                             "tracker",
                             "sequences",
                             "AUC",
                             "95 %",
                             "P@20",
                             "NP",
                             "AO",
                             "SR50",
                             "centre px",
                             "mrad",
                             "lost",
                             "frames/s",
                             "median"));
  for (const tracker_evaluation::ScoredTracker& tracker : assessment.trackers)
    if (tracker.overall) console.result(one_pass_line(tracker, *tracker.overall));
}

void print_vot(const tracker_evaluation::Assessment& assessment, Console& console) {
  const auto [low, high] = assessment.eao_range;
  for (const tracker_evaluation::ScoredTracker& tracker : assessment.trackers) {
    if (tracker.restart)
      console.result(
          fmt::format("{:<20} restart: accuracy {:.3f}, {:.2f} failures a run, reliability {:.3f}, "
                      "EAO[{}, {}] {}",
                      tracker.name,
                      tracker.restart->accuracy,
                      tracker.restart->failures,
                      tracker.restart->reliability,
                      low,
                      high,
                      number(tracker.restart->eao, 3)));
    if (tracker.multistart)
      console.result(
          fmt::format("{:<20} multistart: accuracy {:.3f}, robustness {:.3f}, EAO[{}, {}] {}",
                      tracker.name,
                      tracker.multistart->accuracy,
                      tracker.multistart->robustness,
                      low,
                      high,
                      number(tracker.multistart->eao, 3)));
  }
}

void print_comparison(const tracker_evaluation::Assessment& assessment, Console& console) {
  if (assessment.comparisons.empty()) return;
  const tracker_evaluation::TrackerPair& best = assessment.comparisons.front();
  const auto& interval = best.auc.interval;
  console.result(fmt::format(
      "{} against {}: AUC {:+.3f}{}, better in {} of {} sequences, p = {:.3f}",
      best.a,
      best.b,
      best.auc.difference,
      interval ? fmt::format(" ({:+.3f} to {:+.3f})", interval->low, interval->high) : "",
      best.auc.wins,
      best.sequences,
      best.auc.p_value));
}

void print_agreement(const tracker_evaluation::Agreement& agreement,
                     const std::string& other,
                     Console& console) {
  console.result(fmt::format("{}: {} trackers in common, Kendall's tau of their AUC {}",
                             other,
                             agreement.trackers.size(),
                             number(agreement.tau, 3)));
}

void set_options(Evaluate& arguments, Context& context) {
  tracker_evaluation::AssessOptions& options = arguments.options;
  if (!arguments.eao_range.empty()) {
    if (arguments.eao_range[1] < arguments.eao_range[0])
      throw Error(fmt::format(
          "--eao-range {} {} goes backward", arguments.eao_range[0], arguments.eao_range[1]));
    options.eao_range = {arguments.eao_range[0], arguments.eao_range[1]};
  }
  options.with_film = !arguments.no_page;
  for (const std::string& text : arguments.where)
    options.where.push_back(sequences::condition_from(text));
  follow(options, context, "reading the videos", "sequences");
  static_cast<report::RunOptions&>(arguments.detections) = options;
  arguments.detections.ignore = arguments.ignore;
}

void evaluate_trackers(const Evaluate& arguments,
                       const std::vector<fs::path>& results,
                       const RunFiles& files,
                       Console& console) {
  const tracker_evaluation::AssessOptions& options = arguments.options;
  const tracker_evaluation::Assessment assessment =
      tracker_evaluation::assess(arguments.set, results, options);
  std::optional<tracker_evaluation::Agreement> agreement;
  if (!arguments.against.empty())
    agreement = tracker_evaluation::agreement(assessment, arguments.against);
  files.write(arguments.out, [&](const fs::path& out) {
    tracker_evaluation::write_tables(assessment, out);
    if (options.with_film) tracker_evaluation::write_page(assessment, out);
    if (!arguments.figures.empty())
      tracker_evaluation::write_figures(assessment, out, arguments.figures);
  });
  console.end_progress();
  print_one_pass(assessment, console);
  print_vot(assessment, console);
  print_comparison(assessment, console);
  if (agreement) print_agreement(*agreement, arguments.against, console);
}

void evaluate_detectors(const Evaluate& arguments,
                        const std::vector<fs::path>& results,
                        const RunFiles& files,
                        Console& console) {
  const scores::Assessment assessment =
      detector_evaluation::assess(arguments.set, results, arguments.detections);
  files.write(arguments.out, [&](const fs::path& out) {
    detector_evaluation::write_tables(assessment, out);
    if (arguments.options.with_film)
      detector_evaluation::write_page(assessment, out, arguments.options);
    if (!arguments.figures.empty())
      detector_evaluation::write_figures(assessment, out, arguments.figures);
  });
  console.end_progress();
  print_detections(assessment, console);
}

// Pages and figures beside the tables that show other numbers than these.
void say_what_is_older(const Evaluate& arguments,
                       bool has_trackers,
                       bool has_detectors,
                       Console& console) {
  const auto say = [&](const char* name, bool is_older) {
    const fs::path shown = fs::path(arguments.out) / name;
    if (is_older && fs::exists(shown))
      console.warning(shown.string() + ": is of an earlier evaluation; this one makes none");
  };
  say("report.html", arguments.no_page && has_trackers);
  say("detection.html", arguments.no_page && has_detectors);
  say("figures", arguments.figures.empty());
}

void run_evaluate(Evaluate arguments, Context& context) {
  if (!arguments.figures.empty()) report::check_figures(arguments.figures);
  if (!arguments.against.empty()) tracker_evaluation::check_evaluation(arguments.against);
  RunFiles files;
  files.reads(arguments.against)
      .reads(arguments.ignore)
      .writes_into(arguments.out, {"evaluation.json", "detection.json"});
  for (const std::string& results : arguments.results)
    if (!fs::is_directory(results)) files.reads(results);
  refuse_twice({arguments.results.begin(), arguments.results.end()});
  files.begin();
  set_options(arguments, context);
  std::vector<fs::path> of_trackers;
  std::vector<fs::path> of_detectors;
  for (const std::string& results : arguments.results)
    (detector_evaluation::holds_detections(results, arguments.is_detections) ? of_detectors
                                                                             : of_trackers)
        .emplace_back(results);
  if (!arguments.against.empty() && of_trackers.empty())
    throw Error("--against compares rankings of trackers, and there are no trackers' results");
  if (!of_detectors.empty()) evaluate_detectors(arguments, of_detectors, files, context.console());
  if (!of_trackers.empty()) evaluate_trackers(arguments, of_trackers, files, context.console());
  files.commit();
  say_what_is_older(arguments, !of_trackers.empty(), !of_detectors.empty(), context.console());
}

// The options that change what is measured.
void add_measure_options(CLI::App* command, Evaluate& arguments) {
  command->add_option("--origin", arguments.options.origin_px)
      ->description("What the results call the first pixel: 0 (default) or 1")
      ->check(CLI::Range(0, 1));
  command->add_option("--eao-range", arguments.eao_range)
      ->description(
          "Lengths over which VOT's expected average overlap is taken, frames (default: "
          "by the data set's own lengths)")
      ->expected(2)
      ->check(CLI::Range(1, 1'000'000));
  command->add_option("--where", arguments.where)
      ->description(
          "KEY=LOW..HIGH: only sequences whose visibility_m, exposure, white_balance, "
          "blur, noise or sun_share is within (docs/formats/scene.md)")
      ->allow_extra_args(false);
  command->add_flag("--speed-until-loss",
                    arguments.options.until_loss,
                    "Frames per second without the frames from the first loss on, where some "
                    "trackers answer at once");
}

// Options of one kind of results have an effect with such results alone.
void expect_results(CLI::App& command, const Evaluate& arguments, Context& context) {
  const auto has = [&arguments](bool detections) {
    return [&arguments, detections] {
      return std::ranges::any_of(arguments.results, [&](const std::string& results) {
        return !fs::exists(results) || detector_evaluation::holds_detections(
                                           results, arguments.is_detections) == detections;
      });
    };
  };
  expect_effect(context,
                command,
                {"--origin", "--eao-range", "--speed-until-loss"},
                "without results of a tracker",
                has(false));
  for (const CLI::Option* option : command.get_options())
    if (option->get_group() == kOfDetectors)
      expect_effect(
          context, command, {option->get_name()}, "without results of a detector", has(true));
}

}  // namespace

void add_evaluate(CLI::App& app, Context& context) {
  auto [command, arguments] = add_command(app, context, "evaluate", run_evaluate);
  command->description("Score trackers' and detectors' results against a data set");
  command->add_option("DIR", arguments->set, "A data set, made or imported")->required();
  command->add_option("RESULTS", arguments->results)
      ->description(
          "Folders of results, one for each tracker or detector; "
          "a detector's may be a COCO results file")
      ->required();
  command->add_option("--out,-o", arguments->out)
      ->description(
          "New folder, or one of an earlier evaluation, for evaluation.json, detection.json, the "
          "tables, report.html and detection.html")
      ->required();
  add_measure_options(command, *arguments);
  add_detection_options(*command, *arguments, context);
  expect_results(*command, *arguments, context);
  command->add_option("--against", arguments->against)
      ->description("Another evaluation.json: how far do the two rankings agree?");
  command->add_option(
      "--figures", arguments->figures, "Also the plots as files for a paper: png, pdf or svg");
  command->add_flag(
      "--no-page", arguments->no_page, "No pages, and no results by contrast: videos are not read");
  add_jobs(*command, arguments->options.jobs, "Videos read at a time");
}

}  // namespace airtruth::cli
