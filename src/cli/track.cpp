// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <charconv>

#include <fmt/format.h>

#include "cli/commands.h"
#include "foundation/base/error.h"
#include "foundation/base/file_state.h"
#include "foundation/base/files.h"
#include "runners/runs/tracker_run.h"
#include "runners/tracking/tracker.h"

namespace airtruth::cli {
namespace {

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

}  // namespace

void add_track(CLI::App& app, Context& context) {
  auto [command, arguments] = add_command(app, context, "track", run_track);
  command->description("Run trackers over a data set or a video");
  add_source_options(*command, *arguments, context);
  add_run_options(*command, *arguments, context);
}

}  // namespace airtruth::cli
