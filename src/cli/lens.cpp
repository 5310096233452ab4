// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include <fmt/format.h>

#include "base/error.h"
#include "base/files.h"
#include "cli/commands.h"
#include "motion/lens_estimate.h"
#include "video/reader.h"
#include "video/still.h"

namespace airtruth::cli {
namespace {

struct EstimateArguments {
  std::string video;
  std::string mask;
  std::string out;
  bool overwrite = false;
};

// An OpenCV calibration that read_calibration() takes.
std::string calibration_text(const motion::LensEstimator::Result& found, int width, int height) {
  return fmt::format(
      "%YAML:1.0\n---\n# estimated by airtruth lens estimate: focal length +- {:.1f} px\n"
      "image_width: {}\nimage_height: {}\nfisheye_model: {}\n"
      "camera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n"
      "   data: [ {}, 0., {}, 0., {}, {}, 0., 0., 1. ]\n"
      "distortion_coefficients: !!opencv-matrix\n   rows: 4\n   cols: 1\n   dt: d\n   data: [ 0., "
      "0., 0., 0. ]\n",
      found.sigma_px,
      width,
      height,
      found.fisheye ? 1 : 0,
      found.focal_px,
      width / 2.0 - 0.5,
      found.focal_px,
      height / 2.0 - 0.5);
}

void estimate(const EstimateArguments& arguments, Context& context) {
  refuse_existing(arguments.out, arguments.overwrite);
  Console& console = context.console();
  video::Reader reader(arguments.video, {}, console.warn());
  const video::StreamInfo info = reader.info();
  std::optional<image::Mask> mask;
  if (!arguments.mask.empty()) mask = video::read_mask(arguments.mask, info.width, info.height);
  motion::LensEstimator estimator(info.width, info.height, mask ? &*mask : nullptr);
  while (const auto frame = reader.next()) {
    if (context.stop.stop_requested()) throw Interrupted();
    estimator.add(frame->picture);
    console.progress("looking", frame->index + 1, info.frame_count_estimate);
  }
  console.end_progress();
  std::string why;
  const auto found = estimator.result(why);
  if (!found) throw Error("does not hold its lens: " + why, {arguments.video});
  if (!arguments.out.empty())
    write_file(arguments.out, calibration_text(*found, info.width, info.height));
  console.result(fmt::format(
      "{}, focal_px {:.1f} +- {:.1f} ({} turns of the camera; {:.2f} px left over, {:.2f} as a {})",
      found->fisheye ? "fisheye (equidistant)" : "pinhole",
      found->focal_px,
      found->sigma_px,
      found->pairs,
      found->rms_px,
      found->other_rms_px,
      found->fisheye ? "pinhole" : "fisheye"));
}

}  // namespace

void add_lens(CLI::App& app, Context& context) {
  auto* group = app.add_subcommand("lens", "Lenses");
  group->require_subcommand(1);
  auto* command = group->add_subcommand(
      "estimate",
      "Tell a camera's lens from a video in which it turns, where no calibration is at hand");
  auto arguments = std::make_shared<EstimateArguments>();
  command->add_option("VIDEO", arguments->video, "The video")->required();
  command->add_option("--mask", arguments->mask, "Own-aircraft mask: black = own aircraft");
  command->add_option("-o,--out", arguments->out, "Calibration to write, for [lens] file (.yml)");
  command->add_flag("--overwrite", arguments->overwrite, "Replace the file if it exists");
  command->callback([arguments, &context] { estimate(*arguments, context); });
}

}  // namespace airtruth::cli
