// SPDX-License-Identifier: Apache-2.0
#include "calibration/camera_file/calibrate.h"

#include <map>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "calibration/camera_file/plot.h"
#include "calibration/camera_file/profile.h"
#include "calibration/own_aircraft/own_aircraft.h"
#include "cli/commands.h"
#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/run_files/run_files.h"
#include "picture/video/still.h"
#include "scene/scene/limits.h"
#include "sequence/insertion/masks.h"
#include "show/plot/gnuplot.h"

namespace airtruth::cli {
namespace {

struct CalibrateArguments : CalibrateOptions {
  std::vector<std::string> videos;
  std::string out;
  std::string plot;
  bool overwrite = false;
};

// One line per profile: its name and camera, and the appearance of its edges.
std::string profile_lines() {
  std::string lines;
  for (const camera_file::CameraProfile& profile : camera_file::camera_profiles())
    lines += fmt::format("{:<18} {} x {} px, {} clip{}: {}\n",
                         profile.name,
                         profile.width,
                         profile.height,
                         profile.clips,
                         profile.clips == 1 ? "" : "s",
                         profile.camera);
  return lines;
}

// All texts of one kind, such as the reasons for missing values, in the order of their keys.
using Texts = std::map<std::string, std::string>;

Texts texts(const camera_file::Quantities& quantities, std::string camera_file::Quantity::*kind) {
  Texts result;
  for (const camera_file::QuantityKey& key : camera_file::kQuantityKeys)
    if (const std::string& text = quantities.*key.member.*kind; !text.empty())
      result[key.name] = text;
  return result;
}

// Reports what is not measured.
void report_missing(const camera_file::Calibration& found, Console& console) {
  Texts missing = texts(found.quantities, &camera_file::Quantity::missing);
  if (!found.no_horizon.empty()) missing["horizon"] = found.no_horizon;
  for (const auto& [key, why] : missing) console.warning(key + " cannot be had: " + why);
  if (!found.horizon_note.empty()) console.warning("horizon is " + found.horizon_note);
  const std::string& note = found.quantities.extinction.note;
  if (!note.empty()) console.warning("air.extinction_per_km is " + note);
}

// Reports which values do not come from the clip alone, and which are doubtful.
void report_sources(const camera_file::Calibration& found, Console& console) {
  for (const auto& [key, source] : texts(found.quantities, &camera_file::Quantity::source)) {
    const Estimate& value = found.quantities.at(key).value();
    console.result(fmt::format("{} = {:.3g} +- {:.2g}: {}", key, value.value, value.sigma, source));
  }
  for (const auto& [key, doubt] : texts(found.quantities, &camera_file::Quantity::doubt))
    console.warning(key + " is doubtful: " + doubt);
}

// Reports how many quantities were measured, and how many of them on the clip alone.
void report_count(const camera_file::Calibration& found, const std::string& out, Console& console) {
  std::size_t measured = 0, own = 0;
  for (const camera_file::QuantityKey& key : camera_file::kQuantityKeys) {
    const camera_file::Quantity& quantity = found.quantities.*key.member;
    measured += quantity.is_measured() ? 1 : 0;
    own += quantity.is_measured() && quantity.source.empty() ? 1 : 0;
  }
  console.result(fmt::format("{}: {} values from {} frames, {} of them {}",
                             out,
                             measured,
                             found.frames,
                             own,
                             found.clips > 1 ? "the clips' own" : "the clip's own"));
}

void write_results(const CalibrateArguments& arguments,
                   const camera_file::Calibration& found,
                   RunFiles& files) {
  files.write(arguments.out,
              [&](const fs::path& at) { write_file(at, camera_file::toml_from(found)); });
  files.write(arguments.plot, [&](const fs::path& at) {
    video::write_still(at,
                       plot::picture_of({.plots = camera_file::plots_of(found),
                                         .columns = 2,
                                         .height = 10,
                                         .legend = plot::Legend::kAbove}));
  });
  files.commit();
}

void calibrate(CalibrateArguments arguments, Context& context) {
  RunFiles files;
  for (const std::string& video : arguments.videos) files.reads(video);
  files.reads(arguments.lens).reads(arguments.mask);
  files.writes(arguments.out, arguments.overwrite, {".toml"})
      .writes(arguments.plot, arguments.overwrite);
  video::check_still_output(arguments.plot, arguments.overwrite);
  if (!arguments.plot.empty()) plot::check_gnuplot("--plot");
  const std::vector<fs::path> clips(arguments.videos.begin(), arguments.videos.end());
  if (clips.size() > 1 && !arguments.plot.empty())
    throw Error("--plot draws one clip; expected one video beside it");
  refuse_twice(clips);
  files.begin();
  follow(arguments, context, "measuring");
  const camera_file::Calibration found = camera_file::calibrate_camera(clips, arguments);
  Console& console = context.console();
  console.end_progress();
  write_results(arguments, found, files);
  report_missing(found, console);
  report_sources(found, console);
  report_count(found, arguments.out, console);
}

struct MaskArguments {
  std::string video;
  std::string out;
  bool overwrite = false;
};

void find_mask(const MaskArguments& arguments, Context& context) {
  RunFiles().reads(arguments.video).writes(arguments.out, arguments.overwrite, {".png"}).check();
  Console& console = context.console();
  own_aircraft::MaskOptions options;
  follow(options, context, "looking");
  const image::Mask mask = own_aircraft::find_own_aircraft(arguments.video, options);
  console.end_progress();
  video::write_still(arguments.out, insertion::picture_of(mask));
  const auto own = std::count(mask.free.begin(), mask.free.end(), 0);
  if (own == 0)
    console.warn()(
        "nothing stays still while the world moves: the picture holds nothing of the own aircraft, "
        "or the camera hardly moves in this clip, which hides it; a clip of the same camera with "
        "turns in it shows it, or a mask drawn by hand, black where the own aircraft is");
  console.result(fmt::format("{}: the own aircraft covers {:.1f} % of the picture",
                             arguments.out,
                             100.0 * double(own) / double(mask.free.size())));
}

// The options that say what a clip alone does not show.
void add_known_facts(CLI::App* command, CalibrateArguments& arguments) {
  command->add_option(
      "--lens", arguments.lens, "Calibration file (docs/lenses.md): for sun and extinction");
  command->add_option("--mask", arguments.mask, "Own-aircraft mask: black = own aircraft");
  command->add_option("--altitude", arguments.altitude_m)
      ->description("Height of the camera above the ground, m: for the extinction")
      ->check(above_0());
  add_number(*command, "--heading", arguments.heading_deg, -360.0, 360.0)
      ->description("Where the camera looks in the first frame, degrees from north: for the sun");
  command->add_option("--gamma", arguments.gamma)
      ->description(
          "Exponent of the camera's tone curve, which one clip does not show [sRGB's curve]")
      ->check(CLI::Range(scene::kGamma.low, scene::kGamma.high));
}

}  // namespace

void add_calibrate(CLI::App& app, Context& context) {
  auto [command, arguments] = add_command(app, context, "calibrate", calibrate);
  command->description("Measure what a clip's camera and air do to light");
  command->add_option("VIDEO", arguments->videos, "The video, or several of one camera")
      ->required();
  command->add_option("-o,--out", arguments->out, "Camera file to write (.toml)")->required();
  add_known_facts(command, *arguments);
  add_frame_rate(*command, arguments->frame_rate_hz);
  command->add_option("--profile", arguments->profile)
      ->description(
          "Known camera, for what the clip does not show; none: the clip's values alone "
          "[the one that the video's tags and size tell, else the median over all]");
  command->add_flag_callback(
      "--list-profiles",
      [] { throw CLI::CallForVersion(profile_lines(), 0); },
      "List the known cameras");
  command->add_option("--plot", arguments->plot, "Draw what was measured here (.png or .jpg)");
  command->add_flag("--overwrite", arguments->overwrite, "Replace files that exist");
}

void add_mask(CLI::App& app, Context& context) {
  auto [command, arguments] = add_command(app, context, "mask", find_mask);
  command->description("Find the own aircraft: what stays still while the world moves");
  command->add_option("VIDEO", arguments->video, "The video")->required();
  command->add_option("-o,--out", arguments->out, "Mask to write: black = own aircraft (.png)")
      ->required();
  command->add_flag("--overwrite", arguments->overwrite, "Replace files that exist");
}

}  // namespace airtruth::cli
