// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include <fmt/format.h>

#include "camera/lens/calibration_file.h"
#include "camera/lens/lens.h"
#include "camera/motion/estimator.h"
#include "cli/commands.h"
#include "foundation/base/error.h"
#include "foundation/base/text.h"
#include "picture/video/reader.h"
#include "picture/video/still.h"
#include "scene/flight_log/local_path.h"
#include "scene/flight_log/log_rates.h"
#include "sequence/setup/from_scene.h"
#include "sequence/setup/motion_source.h"

namespace airtruth::cli {
namespace {

using flight_log::FlightLog;

template <typename Record>
std::string records(const std::vector<Record>& list, const char* what) {
  if (list.empty()) return fmt::format("{}: none", what);
  const double first_s = list.front().time_s, last_s = list.back().time_s,
               span_s = last_s - first_s;
  const auto gaps = flight_log::gaps(list, 0, first_s, last_s);
  const auto longest = std::ranges::max_element(gaps, {}, &flight_log::Gap::length_s);
  return fmt::format(
      "{}: {}, {:.3f} to {:.3f} s, {:.1f} a second{}",
      what,
      list.size(),
      first_s,
      last_s,
      span_s > 0 ? static_cast<double>(list.size() - 1) / span_s : 0.0,
      longest == gaps.end()
          ? ""
          : fmt::format(
                ", the longest gap from {:.3f} to {:.3f} s", longest->from_s, longest->to_s));
}

std::string range_of(const FlightLog& log, double flight_log::Fix::*member, int digits) {
  const auto [low, high] = std::ranges::minmax_element(log.fixes, {}, member);
  return fmt::format("{:.{}g} to {:.{}g}", (*low).*member, digits, (*high).*member, digits);
}

// Distance flown and the highest speed over the path that a scene would take from the log.
std::string flown(const FlightLog& log) {
  const double first_s = log.fixes.front().time_s, last_s = log.fixes.back().time_s;
  constexpr double kMinSpanS = 1;  // a path needs positions in two half seconds
  if (last_s - first_s < kMinSpanS) return "flown: the positions span less than a second";
  const auto path =
      flight_log::local_path(FlightLog{.fixes = log.fixes}, {first_s, Vector3::Zero()});
  // Step at which the path is walked.
  constexpr double kStepS = 0.5;
  double distance_m = 0, top_mps = 0;
  for (double t = 0; t < last_s - first_s; t += kStepS) {
    const double speed_mps = path.at(t)->velocity_in_world_mps.norm();
    distance_m += kStepS * speed_mps;
    top_mps = std::max(top_mps, speed_mps);
  }
  return fmt::format("flown: {:.0f} m, at up to {:.1f} m/s", distance_m, top_mps);
}

std::string description(const FlightLog& log) {
  std::string text =
      fmt::format("{}, on {}\n",
                  name(log.format),
                  log.is_on_video_clock ? "the video's clock" : "a clock of its own");
  text += records(log.fixes, "positions") + "\n";
  // Six decimals of up to 180 degrees: steps of 0.1 m.
  constexpr int kDegreeDigits = 9;
  text += fmt::format("latitude: {} degrees\nlongitude: {} degrees\naltitude: {} m\n",
                      range_of(log, &flight_log::Fix::latitude_deg, kDegreeDigits),
                      range_of(log, &flight_log::Fix::longitude_deg, kDegreeDigits),
                      range_of(log, &flight_log::Fix::altitude_m, 6));
  if (const auto& height_m = log.fixes.front().height_m)
    text += fmt::format("height above take-off: {:.1f} m at the first position\n", *height_m);
  text += flown(log) + "\n";
  text += records(log.attitudes, "attitudes") + "\n" + records(log.rates, "turn rates");
  if (log.left_out > 0)
    text += fmt::format(
        "\nleft out: {} records without a fix, at a time that does not increase, or "
        "with a fault",
        log.left_out);
  if (!log.first_fault.empty()) text += "\nthe first fault: " + log.first_fault;
  return text;
}

void show_log(const std::string& file, Context& context) {
  context.console().result(description(setup::read_log(file)));
}

struct AlignArguments {
  std::string log;
  std::string video;
  std::string lens;
  std::string mask;
  double fov_deg = 0;
  std::int64_t first_frame = 0;
  std::optional<double> frame_rate_hz;
};

lens::Lens lens_of(const AlignArguments& arguments,
                   const video::StreamInfo& info,
                   const Warn& warn) {
  const lens::ImageSize size{info.width, info.height};
  if (!arguments.lens.empty()) return lens::read_calibration(arguments.lens, size, warn);
  if (arguments.fov_deg > 0)
    return lens::pinhole_from_vertical_fov(arguments.fov_deg, size, info.sample_aspect.value());
  throw Error("--lens or --fov is missing; expected the camera's calibration or vertical view");
}

std::vector<motion::FrameMotion> motion_of(const AlignArguments& arguments, Context& context) {
  Console& console = context.console();
  video::ReaderOptions options;
  options.first_frame = arguments.first_frame;
  options.picture_rate_hz = arguments.frame_rate_hz;
  options.with_cuts = true;
  video::Reader reader(arguments.video, options, console.warn());
  video::expect_rate(arguments.video, reader.info(), arguments.frame_rate_hz);
  const video::StreamInfo info = reader.info();
  std::optional<image::Mask> mask;
  if (!arguments.mask.empty()) mask = video::read_mask(arguments.mask, info.width, info.height);
  const std::int64_t total = info.frame_count_estimate - arguments.first_frame;
  auto motion = setup::measure_motion(
      std::move(reader),
      motion::Estimator(lens_of(arguments, info, console.warn()), {}, mask ? &*mask : nullptr),
      context.stop,
      [&](std::int64_t done) { console.progress("measuring the motion", done, total); });
  console.end_progress();
  return motion;
}

void align(const AlignArguments& arguments, Context& context) {
  const FlightLog log = setup::read_log(arguments.log);
  const auto rates = flight_log::gyro_samples(log);
  if (rates.size() < 2)
    throw Error(
        "holds no attitudes and no turn rates; expected a log with either, or log_offset_s "
        "from another source",
        {arguments.log});
  const auto motion = motion_of(arguments, context);
  const flight_log::Alignment found = flight_log::aligned(rates, motion);
  if (!found.fit) throw Error("cannot be aligned: " + found.why, {arguments.log});
  // A scene's times count from the first frame that it uses.
  const std::string first =
      arguments.first_frame > 0
          ? fmt::format("[background]\nfirst_frame = {}\n", arguments.first_frame)
          : "";
  context.console().result(fmt::format(
      "the log's time is the clip's plus {:.3f} +- {:.3f} s (correlation of turn rates {:.2f}; "
      "beyond "
      "{:.0f} s of it {:.2f} at most)\nfor a scene:\n{}[camera]\nlog = {}\nlog_offset_s = {:.3f}",
      found.fit->offset_s,
      found.fit->offset_sigma_s,
      found.fit->correlation,
      flight_log::kApartS,
      found.other_correlation,
      first,
      toml_string(arguments.log),
      found.fit->offset_s));
}

void add_log_show(CLI::App& group, Context& context) {
  auto [command, file] = add_command(group, context, "show", show_log);
  command->description("Say what is in a flight log");
  command->add_option("FILE", *file)
      ->description("DJI .srt, GoPro .mp4, PX4 .ulg, ArduPilot .bin, .gpx or .csv")
      ->required();
}

void add_align(CLI::App& group, Context& context) {
  auto [command, arguments] = add_command(group, context, "align", align);
  command->description(
      "Find the time of a log at a video's first frame, from the turn rates of both");
  command->add_option("LOG", arguments->log, "Flight log with attitudes or turn rates")->required();
  command->add_option("VIDEO", arguments->video, "Video of the same flight")->required();
  command->add_option("--lens", arguments->lens, "Calibration file (docs/lenses.md)");
  command->add_option("--fov", arguments->fov_deg, "Vertical view of a pinhole, degrees")
      ->check(CLI::Range(1.0, 179.0));
  const std::string& lens = arguments->lens;
  expect_effect(context, *command, {"--fov"}, "with --lens", [&lens] { return lens.empty(); });
  command->add_option("--mask", arguments->mask, "Own-aircraft mask: black = own aircraft");
  add_frame_rate(*command, arguments->frame_rate_hz);
  command->add_option("--first-frame", arguments->first_frame)
      ->description("First frame of the video that counts [0]")
      ->check(CLI::Range(std::int64_t{0}, std::int64_t{1'000'000'000}));
}

}  // namespace

void add_log(CLI::App& app, Context& context) {
  auto* group = app.add_subcommand("log", "Flight logs: where the own aircraft really flew");
  group->require_subcommand(1);
  add_log_show(*group, context);
  add_align(*group, context);
}

}  // namespace airtruth::cli
