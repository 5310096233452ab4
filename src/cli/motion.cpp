// SPDX-License-Identifier: Apache-2.0
#include "camera/motion/motion.h"

#include <memory>
#include <optional>

#include <fmt/format.h>

#include "camera/lens/calibration_file.h"
#include "camera/motion/estimator.h"
#include "camera/motion/shake.h"
#include "camera/motion/stabilise.h"
#include "cli/commands.h"
#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/run_files/run_files.h"
#include "picture/video/still.h"
#include "picture/video/writer.h"
#include "scene/scene/choices.h"
#include "sequence/setup/motion_source.h"
#include "show/motion_plot/motion_plot.h"
#include "show/plot/gnuplot.h"

namespace airtruth::cli {
namespace {

struct MotionArguments {
  std::string video;
  std::string out;
  std::string mask;
  std::string plot;
  std::string stabilised;
  std::string model = "auto";
  std::string lens;
  std::string reference = "first_frame";
  double smoothing_s = 1;
  bool overwrite = false;
};

// The lens for a rotation; empty for a homography. The default is that of scenes, a rotation,
// where a lens is stated: without one no rotation can be measured.
std::optional<lens::Lens> lens_of(const MotionArguments& arguments,
                                  const lens::ImageSize& size,
                                  const Warn& warn) {
  const auto model = enum_named<scene::MotionModel>(arguments.model);
  if (model == scene::MotionModel::kHomography && !arguments.lens.empty())
    throw Error("--lens is for --model rotation; a homography knows no lens");
  if (model == scene::MotionModel::kRotation && arguments.lens.empty())
    throw Error("--model rotation needs --lens, a calibration file");
  if (arguments.lens.empty()) return std::nullopt;
  return lens::read_calibration(arguments.lens, size, warn);
}

void stabilise(const MotionArguments& arguments,
               const fs::path& out,
               const std::vector<motion::FrameMotion>& all,
               const std::optional<lens::Lens>& lens,
               Context& context) {
  video::WriterOptions options;
  options.format = video::format_of_file(out);
  video::Reader reader(arguments.video);
  video::Writer writer(out, reader.info(), options);
  while (auto frame = reader.next()) {
    if (context.stop.stop_requested()) throw Interrupted();
    const auto& motion = all[static_cast<std::size_t>(frame->index)];
    frame->picture = motion.rotation
                         ? motion::stabilised(frame->picture, *lens, *motion.rotation)
                         : motion::stabilised(frame->picture, motion.frame_from_reference);
    writer.write(*frame);
    context.console().progress(
        "stabilising", frame->index + 1, static_cast<std::int64_t>(all.size()));
  }
  writer.finish();
}

void check_files(const MotionArguments& arguments, RunFiles& files) {
  for (const std::string& file : {arguments.video, arguments.mask, arguments.lens})
    files.reads(file);
  for (const std::string& file : {arguments.out, arguments.stabilised, arguments.plot})
    files.writes(file, arguments.overwrite);
  video::check_still_output(arguments.plot, arguments.overwrite);
  if (!arguments.plot.empty()) plot::check_gnuplot("--plot");
  if (!arguments.stabilised.empty()) video::format_of_file(arguments.stabilised);
  files.begin();
}

void report_gyro(const std::optional<gyro::GyroFit>& fit, bool has_gyro, Console& console) {
  if (fit)
    console.result(
        fmt::format("gyro: agrees to {:.3f} (offset {:.3f} s, {:.3f} degrees/s rms); frames not "
                    "measured follow it",
                    fit->correlation,
                    fit->offset_s,
                    degrees(fit->rms_radps)));
  else if (has_gyro)
    console.warning("the video's gyro does not agree with its motion; it is not used");
}

void report_frames(const std::vector<motion::FrameMotion>& all,
                   const MotionArguments& arguments,
                   Console& console) {
  std::size_t measured = 0;
  std::size_t away = 0;
  for (const auto& frame : all) {
    measured += motion::is_known(frame.state) ? 1 : 0;
    away += frame.state == motion::State::kTurnedAway ? 1 : 0;
  }
  if (away > 0)
    console.warning(
        fmt::format("in {} frames the camera has turned so far from the first that no homography "
                    "holds both (turned_away); --reference smoothed and --model rotation have no "
                    "such limit",
                    away));
  const bool is_chosen = arguments.model == "auto" && arguments.lens.empty();
  console.result(
      fmt::format("{}: {} frames, measured in {}{}",
                  arguments.out,
                  all.size(),
                  measured,
                  is_chosen ? " (homography; with --lens rotation, the default of scenes)" : ""));
}

void measure(const MotionArguments& arguments, Context& context) {
  RunFiles files;
  check_files(arguments, files);
  Console& console = context.console();
  video::Reader reader(arguments.video, {.with_cuts = true}, console.warn());
  const video::StreamInfo info = reader.info();
  std::optional<image::Mask> mask;
  if (!arguments.mask.empty()) mask = video::read_mask(arguments.mask, info.width, info.height);
  motion::Options options;
  options.smoothing_s = arguments.smoothing_s;
  const image::Mask* own_aircraft = mask ? &*mask : nullptr;
  const auto lens = lens_of(arguments, {info.width, info.height}, console.warn());
  motion::Estimator estimator =
      lens ? motion::Estimator(*lens, options, own_aircraft)
           : motion::Estimator(info.width, info.height, options, own_aircraft);
  auto all =
      setup::measure_motion(reader, std::move(estimator), context.stop, [&](std::int64_t done) {
        console.progress("measuring", done, info.frame_count_estimate);
      });
  const auto gyro = lens ? setup::gyro_of(arguments.video) : std::vector<gyro::GyroSample>();
  report_gyro(setup::bridge_by_gyro(gyro, all), !gyro.empty(), console);
  all = enum_named<scene::MotionReference>(arguments.reference) == scene::MotionReference::kSmoothed
            ? motion::smoothed(std::move(all), options)
            : motion::within_reach(std::move(all), info.width, info.height);
  files.write(arguments.out,
              [&](const fs::path& at) { write_file(at, motion::csv_from_motion(all)); });
  files.write(arguments.plot, [&](const fs::path& at) {
    video::write_still(
        at,
        plot::picture_of({.plots = motion_plot::plots_of(all, info.width, info.height),
                          .height = 12,
                          .legend = plot::Legend::kAbove}));
  });
  files.write(arguments.stabilised,
              [&](const fs::path& at) { stabilise(arguments, at, all, lens, context); });
  files.commit();
  report_frames(all, arguments, console);
}

}  // namespace

void add_motion(CLI::App& app, Context& context) {
  auto [command, arguments] =
      add_command(app, context, "motion", "Measure how a video's camera moved", measure);
  command->add_option("VIDEO", arguments->video, "The video")->required();
  command
      ->add_option(
          "-o,--out",
          arguments->out,
          "Table to write: frame,time_s,h11..h33 (or qw,qx,qy,qz),inliers,rms_px,state (.csv)")
      ->required();
  command
      ->add_option("--model",
                   arguments->model,
                   "rotation: on the sphere, through a known lens; homography: one plane; auto: "
                   "rotation with --lens, homography without")
      ->check(CLI::IsMember({"auto", "rotation", "homography"}))
      ->capture_default_str();
  command->add_option("--lens", arguments->lens, "Calibration (OpenCV or Gyroflow), for rotation");
  command->add_option("--mask", arguments->mask, "Own-aircraft mask: black = own aircraft");
  command->add_option("--plot", arguments->plot, "Draw the motion here (.png)");
  command->add_option(
      "--stabilised", arguments->stabilised, "Write a steadied copy of the video here");
  command->add_option("--reference", arguments->reference, "first_frame or smoothed")
      ->check(CLI::IsMember({"first_frame", "smoothed"}))
      ->capture_default_str();
  command
      ->add_option(
          "--smoothing", arguments->smoothing_s, "smoothed: width of the window in seconds")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_flag("--overwrite", arguments->overwrite, "Replace files that exist");
}

}  // namespace airtruth::cli
