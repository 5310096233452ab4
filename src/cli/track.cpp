// SPDX-License-Identifier: Apache-2.0
#include "dataset/track.h"

#include <algorithm>
#include <memory>

#include <fmt/format.h>

#include "base/error.h"
#include "cli/commands.h"
#include "dataset/evaluate.h"
#include "tracking/tracker.h"

namespace airtruth::cli {
namespace {

struct Track {
  std::string set;
  std::string out;
  std::vector<std::string> trackers;
  dataset::TrackOptions options;
};

void run_track(Track arguments, Context& context) {
  Console& console = context.console();
  dataset::TrackOptions& options = arguments.options;
  options.warn = console.warn();
  options.stop = context.stop;
  for (const std::string& tracker : arguments.trackers) {
    options.tracker = tracker;
    options.progress = [&](std::int64_t done, std::int64_t total) {
      console.progress("tracking with " + tracker, done, total, "sequences");
    };
    const dataset::TrackSummary summary = dataset::track(arguments.set, arguments.out, options);
    const double rate =
        summary.seconds > 0 ? static_cast<double>(summary.frames) / summary.seconds : 0;
    console.result(fmt::format("{}: {} sequences tracked{}, {} were there",
                               (dataset::fs::path(arguments.out) / tracker).string(),
                               summary.made,
                               rate > 0 ? fmt::format(" at {:.0f} frames/s", rate) : "",
                               summary.kept));
  }
}

struct Evaluate {
  std::string set;
  std::vector<std::string> results;
  std::string out;
  int origin_px = 0;
};

void run_evaluate(const Evaluate& arguments, Context& context) {
  Console& console = context.console();
  const std::vector<dataset::fs::path> results(arguments.results.begin(), arguments.results.end());
  std::vector<dataset::ScoredTracker> trackers =
      dataset::evaluate(arguments.set, results, arguments.origin_px, console.warn());
  std::stable_sort(trackers.begin(), trackers.end(), [](const auto& a, const auto& b) {
    return a.overall.auc > b.overall.auc;
  });
  dataset::write_evaluation(trackers, arguments.out);
  console.result(fmt::format("{:<20} {:>9} {:>6} {:>6} {:>6} {:>6} {:>6} {:>9} {:>8} {:>8} {:>9}",
                             "tracker",
                             "sequences",
                             "AUC",
                             "P@20",
                             "NP",
                             "AO",
                             "SR50",
                             "centre px",
                             "x px",
                             "y px",
                             "frames/s"));
  for (const dataset::ScoredTracker& tracker : trackers) {
    const evaluation::Score& s = tracker.overall;
    console.result(
        fmt::format("{:<20} {:>9} {:>6.3f} {:>6.3f} {:>6.3f} {:>6.3f} {:>6.3f} {:>9.2f} {:>8.2f} "
                    "{:>8.2f} {:>9.1f}",
                    tracker.name,
                    tracker.sequences.size(),
                    s.auc,
                    s.precision_20px,
                    s.normalised_auc,
                    s.average_overlap,
                    s.success_50,
                    s.centre_mean_px,
                    s.x_mean_px,
                    s.y_mean_px,
                    s.frames_per_second));
  }
}

}  // namespace

void add_track(CLI::App& app, Context& context) {
  auto arguments = std::make_shared<Track>();
  auto* command = app.add_subcommand("track", "Run trackers over a data set");
  command->add_option("DIR", arguments->set, "A data set, made or imported")->required();
  std::string names;
  for (const std::string& name : tracking::tracker_names())
    names += (names.empty() ? "" : ", ") + name;
  command->add_option("--tracker,-t", arguments->trackers, "One or more of " + names)->required();
  command
      ->add_option("--out,-o",
                   arguments->out,
                   "Results, a folder for each tracker; a run that was stopped goes on in it")
      ->required();
  command->add_option("--only", arguments->options.only, "Sequences whose name fits (* and ?)");
  command->add_option("--seed", arguments->options.seed, "Of the trackers' chance (default: 1)");
  command
      ->add_option("--jobs,-j",
                   arguments->options.jobs,
                   "Sequences at a time (default: 1, so that times are a tracker's own)")
      ->check(CLI::Range(1, 1024));
  command->callback([arguments, &context] { run_track(*arguments, context); });
}

void add_evaluate(CLI::App& app, Context& context) {
  auto arguments = std::make_shared<Evaluate>();
  auto* command = app.add_subcommand("evaluate", "Score trackers' results against a data set");
  command->add_option("DIR", arguments->set, "A data set, made or imported")->required();
  command->add_option("RESULTS", arguments->results, "Folders of results, one for each tracker")
      ->required();
  command->add_option("--out,-o", arguments->out, "Folder for evaluation.json and the tables")
      ->required();
  command
      ->add_option("--origin",
                   arguments->origin_px,
                   "What the results call the first pixel: 0 (default) or 1")
      ->check(CLI::Range(0, 1));
  command->callback([arguments, &context] { run_evaluate(*arguments, context); });
}

}  // namespace airtruth::cli
