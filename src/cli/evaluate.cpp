// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <memory>

#include <fmt/format.h>

#include "cli/commands.h"
#include "cli/evaluate_detections.h"
#include "evaluation/detector_evaluation/page.h"
#include "evaluation/detector_evaluation/tables.h"
#include "evaluation/report/plots.h"
#include "evaluation/tracker_evaluation/assess.h"
#include "evaluation/tracker_evaluation/page.h"
#include "evaluation/tracker_evaluation/tables.h"
#include "foundation/base/error.h"
#include "foundation/base/file_state.h"

namespace airtruth::cli {
namespace {

namespace fs = std::filesystem;

struct Evaluate {
  std::string set;
  std::vector<std::string> results;
  std::string out;
  std::vector<int> eao_range;
  std::string against;
  bool no_page = false;
  std::string figures;
  tracker_evaluation::AssessOptions options;
  EvaluateDetections detections;
};

std::string one_pass_line(const tracker_evaluation::ScoredTracker& tracker,
                          const evaluation::Score& s) {
  const auto interval = tracker.intervals.at("auc");
  return fmt::format(
      "{:<20} {:>9} {:>6.3f} {:>15} {:>6.3f} {:>6.3f} {:>6.3f} {:>6.3f} {:>9.1f} {:>7} {:>4} "
      "{:>10.1f} {:>10.1f}",
      tracker.name,
      std::count_if(tracker.sequences.begin(),
                    tracker.sequences.end(),
                    [](const auto& sequence) { return sequence.score.has_value(); }),
      s.auc,
      interval ? fmt::format("{:.3f} to {:.3f}", interval->low, interval->high) : "-",
      s.precision_20px,
      s.normalised_auc,
      s.average_overlap,
      s.success_50,
      s.centre_mean_px,
      number(tracker.angle_mrad, 1),
      tracker.lost,
      s.frames_per_second,
      s.frames_per_second_median);
}

void print_one_pass(const tracker_evaluation::Assessment& assessment, Console& console) {
  console.result(fmt::format(
      "{:<20} {:>9} {:>6} {:>15} {:>6} {:>6} {:>6} {:>6} {:>9} {:>7} {:>4} {:>10} {:>10}",
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
  Console& console = context.console();
  tracker_evaluation::AssessOptions& options = arguments.options;
  if (!arguments.eao_range.empty()) {
    if (arguments.eao_range[1] < arguments.eao_range[0])
      throw Error(fmt::format(
          "--eao-range {} {} goes backward", arguments.eao_range[0], arguments.eao_range[1]));
    options.eao_range = {arguments.eao_range[0], arguments.eao_range[1]};
  }
  options.with_film = !arguments.no_page;
  options.warn = console.warn();
  options.stop = context.stop;
  options.progress = [&console](std::int64_t done, std::int64_t total) {
    console.progress("reading the videos", done, total, "sequences");
  };
  detector_evaluation::AssessOptions& detections = arguments.detections.options;
  detections.ignore = arguments.detections.ignore;
  detections.with_film = options.with_film;
  detections.jobs = options.jobs;
  detections.warn = options.warn;
  detections.stop = options.stop;
  detections.progress = options.progress;
}

void evaluate_trackers(const Evaluate& arguments,
                       const std::vector<fs::path>& results,
                       Console& console) {
  const tracker_evaluation::AssessOptions& options = arguments.options;
  const tracker_evaluation::Assessment assessment =
      tracker_evaluation::assess(arguments.set, results, options);
  std::optional<tracker_evaluation::Agreement> agreement;
  if (!arguments.against.empty())
    agreement = tracker_evaluation::agreement(assessment, arguments.against);
  tracker_evaluation::write_tables(assessment, arguments.out);
  if (options.with_film) tracker_evaluation::write_page(assessment, arguments.out);
  if (!arguments.figures.empty())
    tracker_evaluation::write_figures(assessment, arguments.out, arguments.figures);
  console.end_progress();
  print_one_pass(assessment, console);
  print_vot(assessment, console);
  print_comparison(assessment, console);
  if (agreement) print_agreement(*agreement, arguments.against, console);
}

void evaluate_detectors(const Evaluate& arguments,
                        const std::vector<fs::path>& results,
                        Console& console) {
  const scores::Assessment assessment =
      detector_evaluation::assess(arguments.set, results, arguments.detections.options);
  detector_evaluation::write_tables(assessment, arguments.out);
  if (arguments.options.with_film)
    detector_evaluation::write_page(assessment,
                                    arguments.out,
                                    {.jobs = arguments.options.jobs,
                                     .progress = arguments.options.progress,
                                     .stop = arguments.options.stop});
  if (!arguments.figures.empty())
    detector_evaluation::write_figures(assessment, arguments.out, arguments.figures);
  console.end_progress();
  print_detections(assessment, console);
}

void run_evaluate(Evaluate arguments, Context& context) {
  if (!arguments.figures.empty()) report::check_figures(arguments.figures);
  if (!arguments.against.empty()) tracker_evaluation::check_evaluation(arguments.against);
  check_output_folder(arguments.out);
  set_options(arguments, context);
  std::vector<fs::path> of_trackers;
  std::vector<fs::path> of_detectors;
  for (const std::string& results : arguments.results)
    (arguments.detections.holds(results) ? of_detectors : of_trackers).emplace_back(results);
  if (!arguments.against.empty() && of_trackers.empty())
    throw Error("--against compares rankings of trackers, and there are no trackers' results");
  if (!of_detectors.empty()) evaluate_detectors(arguments, of_detectors, context.console());
  if (!of_trackers.empty()) evaluate_trackers(arguments, of_trackers, context.console());
}

// The options that change what is measured.
void add_measure_options(CLI::App* command, Evaluate& arguments) {
  command
      ->add_option("--origin",
                   arguments.options.origin_px,
                   "What the results call the first pixel: 0 (default) or 1")
      ->check(CLI::Range(0, 1));
  command
      ->add_option("--eao-range",
                   arguments.eao_range,
                   "Lengths over which VOT's expected average overlap is taken, frames (default: "
                   "by the data set's own lengths)")
      ->expected(2)
      ->check(CLI::Range(1, 1'000'000));
  command->add_flag("--speed-until-loss",
                    arguments.options.until_loss,
                    "Frames per second without the frames from the first loss on, where some "
                    "trackers answer at once");
}

}  // namespace

void add_evaluate(CLI::App& app, Context& context) {
  auto arguments = std::make_shared<Evaluate>();
  auto* command =
      app.add_subcommand("evaluate", "Score trackers' and detectors' results against a data set");
  command->add_option("DIR", arguments->set, "A data set, made or imported")->required();
  command
      ->add_option("RESULTS",
                   arguments->results,
                   "Folders of results, one for each tracker or detector; "
                   "a detector's may be a COCO results file")
      ->required();
  command
      ->add_option(
          "--out,-o",
          arguments->out,
          "Folder for evaluation.json, detection.json, the tables, report.html and detection.html")
      ->required();
  add_measure_options(command, *arguments);
  add_detection_options(*command, arguments->detections);
  command->add_option("--against",
                      arguments->against,
                      "Another evaluation.json: how far do the two rankings agree?");
  command->add_option(
      "--figures", arguments->figures, "Also the plots as files for a paper: png, pdf or svg");
  command->add_flag(
      "--no-page", arguments->no_page, "No pages, and no results by contrast: videos are not read");
  command->add_option("--jobs,-j", arguments->options.jobs, "Videos read at a time")
      ->check(CLI::Range(1, 1024));
  command->callback([arguments, &context] { run_evaluate(*arguments, context); });
}

}  // namespace airtruth::cli
