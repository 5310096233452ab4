// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <optional>
#include <string>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "cli/commands.h"
#include "foundation/base/error.h"
#include "foundation/base/file_state.h"
#include "foundation/base/text.h"
#include "runners/runs/detector_run.h"

namespace airtruth::cli {
namespace {

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

void add_detect(CLI::App& app, Context& context) {
  auto [command, arguments] = add_command(app, context, "detect", run_detect);
  command->description("Run detectors over a data set or a video");
  add_options(*command, *arguments, context);
}

}  // namespace airtruth::cli
