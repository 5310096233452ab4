// SPDX-License-Identifier: Apache-2.0
#include "camera/motion/motion.h"

#include <optional>

#include <fmt/format.h>

#include "camera/gyro/gyro.h"
#include "camera/lens/lens.h"
#include "camera/motion/stabilise.h"
#include "cli/commands.h"
#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/base/names.h"
#include "foundation/run_files/run_files.h"
#include "picture/video/reader.h"
#include "picture/video/still.h"
#include "picture/video/writer.h"
#include "scene/scene/scene.h"
#include "sequence/setup/motion_source.h"
#include "show/motion_plot/motion_plot.h"
#include "show/plot/gnuplot.h"

namespace airtruth::cli {
namespace {

struct MotionArguments : setup::ClipMotionOptions {
  std::string video;
  std::string out;
  std::string plot;
  std::string stabilised;
  std::string model_name = "auto";
  std::string reference_name = "first_frame";
  bool overwrite = false;
};

void stabilise(const MotionArguments& arguments,
               const fs::path& out,
               const std::vector<motion::FrameMotion>& all,
               const std::optional<lens::Lens>& lens,
               Context& context) {
  video::WriterOptions options;
  options.format = video::format_of_file(out);
  video::Reader reader(arguments.video, {.picture_rate_hz = arguments.picture_rate_hz});
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
  files.reads(arguments.video).reads(arguments.mask).reads(arguments.lens);
  files.writes(arguments.out, arguments.overwrite, {".csv"});
  for (const std::string& file : {arguments.stabilised, arguments.plot})
    files.writes(file, arguments.overwrite);
  video::check_still_output(arguments.plot, arguments.overwrite);
  if (!arguments.plot.empty()) plot::check_gnuplot("--plot");
  if (!arguments.stabilised.empty()) video::format_of_file(arguments.stabilised);
  files.begin();
  if (!arguments.stabilised.empty())
    video::check_output(video::Reader(arguments.video).info(),
                        video::format_of_file(arguments.stabilised),
                        {arguments.stabilised});
}

void report_gyro(const std::optional<gyro::GyroFit>& fit, Console& console) {
  if (fit)
    console.result(
        fmt::format("gyro: agrees to {:.3f} (offset {:.3f} s, {:.3f} degrees/s rms); frames not "
                    "measured follow it",
                    fit->correlation,
                    fit->offset_s,
                    degrees(fit->rms_radps)));
}

void report_frames(const std::vector<motion::FrameMotion>& all,
                   const MotionArguments& arguments,
                   Console& console) {
  std::size_t measured = 0;
  for (const auto& frame : all) measured += motion::is_known(frame.state) ? 1 : 0;
  const bool is_chosen = arguments.model_name == "auto" && arguments.lens.empty();
  console.result(
      fmt::format("{}: {} frames, measured in {}{}",
                  arguments.out,
                  all.size(),
                  measured,
                  is_chosen ? " (homography; with --lens rotation, the default of scenes)" : ""));
}

void measure(MotionArguments arguments, Context& context) {
  RunFiles files;
  check_files(arguments, files);
  Console& console = context.console();
  arguments.model = *enum_named<scene::MotionModel>(arguments.model_name);
  arguments.reference = *enum_named<scene::MotionReference>(arguments.reference_name);
  follow(arguments, context, "measuring");
  const setup::ClipMotion found = setup::clip_motion(arguments.video, arguments);
  const std::vector<motion::FrameMotion>& all = found.frames;
  report_gyro(found.gyro, console);
  files.write(arguments.out, [&](const fs::path& at) {
    write_file(at, [&](const AddBytes& add) { motion::write_csv(add, all); });
  });
  files.write(arguments.plot, [&](const fs::path& at) {
    video::write_still(
        at,
        plot::picture_of({.plots = motion_plot::plots_of(all, found.info.width, found.info.height),
                          .height = 16,
                          .legend = plot::Legend::kAbove}));
  });
  files.write(arguments.stabilised,
              [&](const fs::path& at) { stabilise(arguments, at, all, found.lens, context); });
  files.commit();
  report_frames(all, arguments, console);
}

}  // namespace

void add_motion(CLI::App& app, Context& context) {
  auto [command, arguments] = add_command(app, context, "motion", measure);
  command->description("Measure how a video's camera moved");
  command->add_option("VIDEO", arguments->video, "The video")->required();
  command->add_option("-o,--out", arguments->out)
      ->description(
          "Table to write: frame,time_s,h11..h33 (or qw,qx,qy,qz),inliers,rms_px,state (.csv)")
      ->required();
  command->add_option("--model", arguments->model_name)
      ->description(
          "rotation: on the sphere, through a known lens; homography: one plane; auto: "
          "rotation with --lens, homography without")
      ->check(CLI::IsMember({"auto", "rotation", "homography"}))
      ->capture_default_str();
  command->add_option("--lens", arguments->lens, "Calibration file (docs/lenses.md), for rotation");
  command->add_option("--mask", arguments->mask, "Own-aircraft mask: black = own aircraft");
  add_frame_rate(*command, arguments->picture_rate_hz);
  command->add_option("--plot", arguments->plot, "Draw the motion here (.png or .jpg)");
  command->add_option(
      "--stabilised", arguments->stabilised, "Write a steadied copy of the video here");
  command->add_option("--reference", arguments->reference_name, "first_frame or smoothed")
      ->check(CLI::IsMember({"first_frame", "smoothed"}))
      ->capture_default_str();
  command->add_option("--smoothing", arguments->smoothing_s)
      ->description("smoothed: standard deviation of the window in seconds")
      ->check(above_0())
      ->capture_default_str();
  const std::string& reference = arguments->reference_name;
  expect_effect(context, *command, {"--smoothing"}, "without --reference smoothed", [&reference] {
    return reference == "smoothed";
  });
  command->add_flag("--overwrite", arguments->overwrite, "Replace files that exist");
}

}  // namespace airtruth::cli
