// SPDX-License-Identifier: Apache-2.0
// Runs of trackers and of detectors.
#include <algorithm>
#include <charconv>
#include <optional>
#include <string>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "cli/commands.h"
#include "foundation/base/error.h"
#include "foundation/base/file_state.h"
#include "foundation/base/files.h"
#include "foundation/base/text.h"
#include "runners/runs/detector_run.h"
#include "runners/runs/tracker_run.h"
#include "runners/tracking/tracker.h"

namespace airtruth::cli {
namespace {

// How fast trackers or detectors were, what an earlier call had made, and what they broke off.
template <typename Summary>
std::string rest_of(const Summary& summary) {
  const double rate =
      summary.seconds > 0 ? static_cast<double>(summary.frames) / summary.seconds : 0;
  return (rate > 0 ? fmt::format(" at {:.0f} frames/s", rate) : "") +
         (summary.kept > 0 ? fmt::format(", {} were there", summary.kept) : "") +
         (summary.broken > 0 ? fmt::format(", {} broken off", summary.broken) : "");
}

// --timeout and --start-timeout, which have an effect on programs that answer alone.
void add_limits(CLI::App& command,
                process::Limits& limits,
                const char* of_an_answer,
                Context& context,
                const std::function<bool()>& has_effect,
                const char* without) {
  const CLI::Range range(0.001, 86'400.0);
  command.add_option("--timeout", limits.answer_s, of_an_answer)->check(range);
  command.add_option("--start-timeout", limits.start_s)
      ->description("Longest that it may take to start, s (default: 30)")
      ->check(range);
  expect_effect(context, command, {"--timeout", "--start-timeout"}, without, has_effect);
}

struct Track {
  std::string source;
  std::string out;
  std::vector<std::string> trackers;
  std::string protocol = "ope";
  std::string init;
  std::int64_t first_frame = 0;
  runs::TrackOptions options;
};

// "x,y,w,h".
Box box_of(const std::string& text) {
  std::vector<double> n;
  const char* at = text.data();
  const char* end = at + text.size();
  while (at < end) {
    double value = 0;
    const auto [stop, fault] = std::from_chars(at, end, value);
    if (fault != std::errc() || (stop != end && *stop != ',')) break;
    n.push_back(value);
    at = stop == end ? end : stop + 1;
  }
  const bool is_box = at == end && n.size() == 4 && !text.ends_with(',');
  if (!is_box || !(n[2] > 0) || !(n[3] > 0) || !(n[2] < 1e6) || !(n[3] < 1e6) ||
      !(std::abs(n[0]) < 1e6) || !(std::abs(n[1]) < 1e6))
    throw Error("--init is '" + text +
                "'; expected x,y,width,height in pixels, with a width and height above 0");
  return {n[0], n[1], n[2], n[3]};
}

void tell(const runs::TrackSummary& summary, const char* unit, Context& context) {
  context.console().result(fmt::format(
      "{}: {} {} tracked{}", summary.folder.string(), summary.made, unit, rest_of(summary)));
  if (summary.broken > 0) context.exit_code = 1;
}

void refuse_mixed(const Track& arguments, bool is_video) {
  const fs::path source = arguments.source;
  if (!fs::exists(source) && source.string().find('%') == std::string::npos)
    throw Error("does not exist", {source.string()});
  if (is_video && arguments.options.protocol != results::Protocol::kOnePass)
    throw Error("--protocol " + arguments.protocol +
                " begins a tracker on truth; a video with --init has none");
  if (!is_video && !fs::is_directory(source))
    throw Error("is a video; give --init x,y,width,height to say what to follow",
                {source.string()});
}

void run_track(Track arguments, Context& context) {
  Console& console = context.console();
  runs::TrackOptions& options = arguments.options;
  options.warn = console.warn();
  options.stop = context.stop;
  options.protocol = results::protocol_from_name(arguments.protocol);
  const bool is_video = !arguments.init.empty();
  refuse_mixed(arguments, is_video);
  const Box init = is_video ? box_of(arguments.init) : Box{};
  check_output_folder(arguments.out);
  // A fault of a second tracker is reported before the first has run for hours. Programs that speak
  // TraX are started only in their turn.
  for (const std::string& tracker : arguments.trackers) {
    options.tracker = tracker;
    if (!tracking::is_trax(tracker)) runs::check_track(arguments.out, options);
  }
  for (const std::string& tracker : arguments.trackers) {
    options.tracker = tracker;
    options.progress = [&](std::int64_t done, std::int64_t total) {
      console.progress("tracking with " + tracker, done, total, is_video ? "frames" : "sequences");
    };
    if (is_video)
      tell(runs::track_video(arguments.source, init, arguments.first_frame, arguments.out, options),
           "video",
           context);
    else
      tell(runs::track(arguments.source, arguments.out, options), "runs", context);
  }
}

// What is followed, by which trackers, and where their results go.
void add_source_options(CLI::App& command, Track& arguments, Context& context) {
  command.add_option("DIR|VIDEO", arguments.source)
      ->description("A data set, made or imported; or a video or folder of images, with --init")
      ->required();
  std::string names;
  for (const std::string& name : tracking::tracker_names()) names += name + ", ";
  command.add_option("--tracker,-t", arguments.trackers)
      ->description("One or more of " + names +
                    "trax:COMMAND for a program that speaks TraX (NAME=trax:COMMAND names its "
                    "results), trax-socket:COMMAND for one that connects to TRAX_SOCKET")
      ->required();
  command.add_option("--out,-o", arguments.out)
      ->description("Results, a folder for each tracker; a run that was stopped goes on in it")
      ->required();
  command.add_option("--protocol",
                     arguments.protocol,
                     "ope: begun once (default); restart: begun anew after each failure; "
                     "multistart: begun at many frames, forward and backward");
  command.add_option(
      "--init", arguments.init, "x,y,width,height of what to follow in a video, pixels from 0");
  command.add_option("--first-frame", arguments.first_frame)
      ->description("Frame of --init (default: 0)")
      ->check(CLI::Range(std::int64_t{0}, std::int64_t{1} << 40));
  expect_effect(context, command, {"--first-frame"}, "without --init", [&arguments] {
    return !arguments.init.empty();
  });
}

void add_run_options(CLI::App& command, Track& arguments, Context& context) {
  runs::TrackOptions& options = arguments.options;
  const auto is_over_set = [&arguments] { return arguments.init.empty(); };
  const auto speaks_trax = [&arguments] {
    return std::ranges::any_of(arguments.trackers, tracking::is_trax);
  };
  const auto is_of = [&](const char* protocol) {
    return [&arguments, protocol] { return arguments.protocol == protocol; };
  };
  command.add_option("--only", options.only, "Sequences whose name fits (* and ?)");
  expect_effect(context, command, {"--only"}, "with --init", is_over_set);
  command.add_option("--seed", options.seed, "Of the trackers' random numbers (default: 1)");
  command.add_option("--repetitions", options.repetitions)
      ->description("Of --protocol restart (default: 1)")
      ->check(CLI::Range(1, 999));
  expect_effect(
      context, command, {"--repetitions"}, "without --protocol restart", is_of("restart"));
  command.add_option("--anchor-step", options.anchor_step)
      ->description("Frames between the starts of --protocol multistart (default: 50)")
      ->check(CLI::Range(1, 1'000'000));
  expect_effect(
      context, command, {"--anchor-step"}, "without --protocol multistart", is_of("multistart"));
  add_limits(command,
             options,
             "Longest that a TraX tracker may take for an answer, s (default: 30)",
             context,
             speaks_trax,
             "without a tracker that speaks TraX");
  add_jobs(
      command, options.jobs, "Sequences at a time (default: 1, so that times are a tracker's own)");
}

struct Detect {
  std::string source;
  std::string out;
  std::string lens;
  std::string mask;
  bool associate = false;
  std::string declare;
  std::optional<double> confident;
  runs::DetectOptions options;
};

void tell(const runs::DetectSummary& summary, Context& context) {
  context.console().result(fmt::format("{}: {} detections in {} frames of {} sequences{}",
                                       summary.folder.string(),
                                       summary.detections,
                                       summary.frames,
                                       summary.made,
                                       rest_of(summary)));
  if (summary.broken > 0) context.exit_code = 1;
}

// "3/5"
void read_declare(const std::string& text, association::AssociationOptions& association) {
  const std::size_t slash = text.find('/');
  const auto number = [&](std::string_view digits) {
    const auto value = number_from_text<int>(digits);
    if (!value) throw Error("--declare is '" + text + "'; expected M/N, such as 3/5");
    return *value;
  };
  if (slash == std::string::npos) number("");
  association.declare_m = number(std::string_view(text).substr(0, slash));
  association.declare_n = number(std::string_view(text).substr(slash + 1));
}

std::optional<association::AssociationOptions> association_of(const Detect& arguments) {
  if (!arguments.associate) return std::nullopt;
  association::AssociationOptions association;
  if (!arguments.declare.empty()) read_declare(arguments.declare, association);
  association.confident_score = arguments.confident;
  return association;
}

void run_detect(Detect arguments, Context& context) {
  runs::DetectOptions& options = arguments.options;
  if (!arguments.lens.empty()) options.lens = arguments.lens;
  if (!arguments.mask.empty()) options.mask = arguments.mask;
  options.association = association_of(arguments);
  if (options.detectors.empty()) options.detectors = {runs::kShippedDetector};
  follow(options, context, "detecting", "done");
  check_output_folder(arguments.out);
  for (const runs::DetectSummary& summary : runs::detect(arguments.source, arguments.out, options))
    tell(summary, context);
}

void add_masks(CLI::App& command, Detect& arguments, Context& context) {
  runs::DetectOptions& options = arguments.options;
  command.add_option(
      "--mask", arguments.mask, "Own-aircraft mask for what states none: black = own aircraft");
  command.add_flag("--use-masks,!--no-masks", options.masks)
      ->description("Nothing is detected, and no motion measured, on the own aircraft (default)");
  command.add_flag("--mask-results", options.mask_results)
      ->description(
          "Leave out what networks and programs detect by more than half on the own aircraft");
  expect_effect(context, command, {"--mask", "--mask-results"}, "with --no-masks", [&options] {
    return options.masks;
  });
}

void add_options(CLI::App& command, Detect& arguments, Context& context) {
  runs::DetectOptions& options = arguments.options;
  command.add_option("DIR|VIDEO", arguments.source)
      ->description("A data set, made or imported; or a video or folder of images")
      ->required();
  command.add_option("--detector,-d", options.detectors)
      ->description(
          fmt::format("One or more of {}, {}; NAME=DETECTOR names its results (default: {})",
                      fmt::join(runs::detector_names(), ", "),
                      fmt::join(runs::detector_forms(), ", "),
                      runs::kShippedDetector));
  command.add_option("--out,-o", arguments.out)
      ->description("Results, a folder for each detector; a run that was stopped goes on in it")
      ->required();
  command.add_option("--only", options.only, "Sequences whose name fits (* and ?)");
  command.add_option(
      "--min-score", options.min_score, "Leave out detections with a lower score (default: none)");
  command.add_option("--max-per-frame", options.max_per_frame)
      ->description("Keep only so many of a frame, those of the highest scores (default: 100)")
      ->check(CLI::Range(1, 100'000));
  command.add_flag(
      "--backgrounds,!--no-backgrounds",
      options.backgrounds,
      "The videos that a set was made over as well, which show no intruder; evaluate does not read "
      "their results (default: the set's sequences alone)");
  expect_effect(context, command, {"--only"}, "on a video", [&arguments] {
    return runs::is_set(arguments.source);
  });
  expect_effect(context, command, {"--backgrounds"}, "on a video", [&arguments] {
    return !arguments.options.backgrounds || runs::is_set(arguments.source);
  });
  add_frame_rate(command, options.frame_rate_hz);
  command.add_option("--lens", arguments.lens)
      ->description("Calibration file for what states no lens (default: a guess of 60 degrees)");
  add_masks(command, arguments, context);
  command.add_flag(
      "--associate", arguments.associate, "Make tracks of the detections, by bearing and size");
  command.add_option("--declare", arguments.declare)
      ->description("M/N: a track is declared with M detections in N frames (default: 3/5)");
  command.add_option("--confident", arguments.confident)
      ->description("Least score that may begin a track (default: the detector's, else any)");
  expect_effect(
      context, command, {"--declare", "--confident"}, "without --associate", [&arguments] {
        return arguments.associate;
      });
  const auto has_program = [&options] {
    return std::ranges::any_of(options.detectors, runs::is_program);
  };
  add_limits(command,
             options,
             "Longest that a program may take for a frame, s (default: 30)",
             context,
             has_program,
             "without a detector that is a program");
  add_jobs(command, options.jobs, "Sequences at a time (default: 1)");
}

}  // namespace

void add_track(CLI::App& app, Context& context) {
  auto [command, arguments] = add_command(app, context, "track", run_track);
  command->description("Run trackers over a data set or a video");
  add_source_options(*command, *arguments, context);
  add_run_options(*command, *arguments, context);
}

void add_detect(CLI::App& app, Context& context) {
  auto [command, arguments] = add_command(app, context, "detect", run_detect);
  command->description("Run detectors over a data set or a video");
  add_options(*command, *arguments, context);
}

}  // namespace airtruth::cli
