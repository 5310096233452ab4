// SPDX-License-Identifier: Apache-2.0
#include <initializer_list>

#include <fmt/format.h>

#include "camera/focal_length/lens_estimator.h"
#include "camera/lens/calibration_file.h"
#include "cli/commands.h"
#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/run_files/run_files.h"
#include "picture/video/reader.h"
#include "picture/video/still.h"

namespace airtruth::cli {
namespace {

// Of calibrations.
constexpr std::initializer_list<const char*> kEndings = {".yml", ".yaml"};

struct EstimateArguments {
  std::string video;
  std::string mask;
  std::string out;
  bool uncertain = false;
  bool overwrite = false;
};

std::string words_of(const focal_length::LensEstimator::Result& found) {
  return fmt::format(
      "{}, focal_px {:.1f}, {} at 95 % ({} turns of the camera; {:.2f} px left over, "
      "{:.2f} as a {})",
      found.fisheye ? "fisheye (equidistant)" : "pinhole",
      found.focal_px,
      focal_length::LensEstimator::interval_words(found, ""),
      found.pairs,
      found.rms_px,
      found.other_rms_px,
      found.fisheye ? "pinhole" : "fisheye");
}

// The result of an estimate: a file, or a table to copy.
void hand_over(const focal_length::LensEstimator::Result& found,
               const std::string& why,
               const video::StreamInfo& info,
               const EstimateArguments& arguments,
               Console& console) {
  const lens::Lens lens = lens::undistorted(
      found.fisheye, found.focal_px, {info.width, info.height}, info.sample_aspect.value());
  console.result(words_of(found) + "\nfor a scene:\n" + lens::scene_table(lens));
  if (!found.is_certain && !arguments.out.empty() && !arguments.uncertain)
    throw Error("is not written: " + why + "; --uncertain writes the estimate all the same",
                {arguments.out});
  if (!found.is_certain) console.warning("this lens is not certain: " + why);
  if (!arguments.out.empty())
    write_file(
        arguments.out,
        lens::opencv_calibration(lens,
                                 fmt::format("{}: focal length {:.1f} px, {} at 95 %{}",
                                             focal_length::kEstimatedNote,
                                             found.focal_px,
                                             focal_length::LensEstimator::interval_words(found),
                                             found.is_certain ? "" : "; not certain")));
}

void estimate(const EstimateArguments& arguments, Context& context) {
  RunFiles()
      .reads(arguments.video)
      .reads(arguments.mask)
      .writes(arguments.out, arguments.overwrite, kEndings)
      .check();
  Console& console = context.console();
  video::Reader reader(arguments.video, {.with_cuts = true}, console.warn());
  const video::StreamInfo info = reader.info();
  std::optional<image::Mask> mask;
  if (!arguments.mask.empty()) mask = video::read_mask(arguments.mask, info.width, info.height);
  focal_length::LensEstimator estimator(
      info.width, info.height, mask ? &*mask : nullptr, info.sample_aspect.value());
  while (const auto frame = reader.next()) {
    if (context.stop.stop_requested()) throw Interrupted();
    estimator.add(frame->picture, frame->begins_shot);
    console.progress("looking", frame->index + 1, info.frame_count_estimate);
  }
  console.end_progress();
  std::string why;
  const auto found = estimator.result(why);
  if (!found) throw Error("does not show its lens: " + why, {arguments.video});
  hand_over(*found, why, info, arguments, console);
}

struct CropArguments {
  std::string file;
  std::string size;
  std::string out;
  bool overwrite = false;
};

void crop(const CropArguments& arguments, Context& context) {
  RunFiles().reads(arguments.file).writes(arguments.out, arguments.overwrite, kEndings).check();
  const auto [width, height] = size_from(arguments.size);
  const lens::Lens whole = lens::read_calibration(arguments.file);
  const lens::Lens lens = lens::cropped(whole, {width, height});
  const std::string from = fmt::format("{}x{}", whole.size().width, whole.size().height);
  if (const double end_rad = lens::facts_of(lens).max_angle_rad; end_rad < kPi)
    context.console().warning(
        fmt::format("the calibration ends at {:.1f} degrees from the axis, which neither OpenCV's "
                    "files nor [lens] in a scene can state; the lens that is written goes on",
                    degrees(end_rad)));
  if (!arguments.out.empty())
    write_file(
        arguments.out,
        lens::opencv_calibration(
            lens,
            fmt::format(
                "the middle of {}, cut by airtruth lens crop out of {}", from, arguments.file)));
  context.console().result("the middle of " + from + ", cut to " + arguments.size +
                           "\nfor a scene:\n" + lens::scene_table(lens));
}

}  // namespace

void add_lens(CLI::App& app, Context& context) {
  auto* group = app.add_subcommand("lens", "Lenses");
  group->require_subcommand(1);
  auto [command, arguments] = add_command(*group, context, "estimate", estimate);
  command->description(
      "Estimate a camera's focal length from a video in which it "
      "turns, where no calibration is at hand");
  command->add_option("VIDEO", arguments->video, "The video")->required();
  command->add_option("--mask", arguments->mask, "Own-aircraft mask: black = own aircraft");
  command->add_option("-o,--out", arguments->out, "Calibration to write, for [lens] file (.yml)");
  command->add_flag("--uncertain", arguments->uncertain)
      ->description("Write the calibration also where other focal lengths fit as well");
  const std::string& out = arguments->out;
  expect_effect(
      context, *command, {"--uncertain"}, "without --out", [&out] { return !out.empty(); });
  command->add_flag("--overwrite", arguments->overwrite, "Replace the file if it exists");

  auto [crop_command, cut] = add_command(*group, context, "crop", crop);
  crop_command->description("Write the lens of a picture that is the middle of the calibrated one");
  crop_command->add_option("CALIBRATION", cut->file, "Calibration (docs/lenses.md)")->required();
  crop_command
      ->add_option("--size", cut->size, "WIDTHxHEIGHT of the video: its largest part of that shape")
      ->required();
  crop_command->add_option("-o,--out", cut->out, "Calibration to write, for [lens] file (.yml)");
  crop_command->add_flag("--overwrite", cut->overwrite, "Replace the file if it exists");
}

}  // namespace airtruth::cli
