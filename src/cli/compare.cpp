// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "cli/commands.h"
#include "comparison/comparison/comparison.h"
#include "foundation/run_files/run_files.h"

namespace airtruth::cli {
namespace {

struct CompareArguments : comparison::Options {
  std::string real;
  std::string boxes;
  std::string scene;
  std::string out;
  double origin_px = 0;
};

void compare(CompareArguments arguments, Context& context) {
  RunFiles()
      .reads(arguments.real)
      .reads(arguments.boxes)
      .reads(arguments.scene)
      .replaces(arguments.out)
      .check();
  Console& console = context.console();
  follow(arguments, context, "comparing");
  const auto found = comparison::compare(arguments.real,
                                         match::read_boxes(arguments.boxes, arguments.origin_px),
                                         scene::read_scene(arguments.scene),
                                         arguments.out,
                                         arguments);
  console.end_progress();
  std::string text = fmt::format("{}: {} frames", found.folder.string(), found.frames);
  if (found.pose)
    text +=
        fmt::format("\n  {}, yaw {:.0f}, pitch {:.0f}, roll {:.0f}: silhouettes overlap by {:.2f}",
                    found.pose->aircraft,
                    found.pose->attitude.yaw_deg,
                    found.pose->attitude.pitch_deg,
                    found.pose->attitude.roll_deg,
                    found.pose->overlap);
  for (const comparison::Pair& p : found.pairs)
    text += fmt::format("\n  {:<44} real {:8.3g}   inserted {:8.3g}", p.name, p.real, p.made);
  console.result(text);
}

// How many frames and pairs, and what is searched for.
void add_match_options(CLI::App& command, CompareArguments& arguments, Context& context) {
  add_number(command, "--pairs", arguments.pairs, 1, 40)->description("Pairs in the figure");
  command
      .add_option("--frames", arguments.most_frames, "At most so many frames from the first box on")
      ->check(above_0());
  command.add_flag(
      "--match,!--no-match",
      arguments.match,
      "Search the type, attitude, livery and sun with which the inserted aircraft looks like the "
      "real one (the default), or take the scene's");
  CLI::Option* types =
      command.add_option("--types", arguments.types)
          ->description("Aircraft to search among (`airtruth aircraft list`), with commas between")
          ->delimiter(',');
  command.add_flag("--helicopter", arguments.helicopter)
      ->description("The real aircraft is a helicopter: search among helicopters, not aeroplanes")
      ->excludes(types);
  expect_effect(context, command, {"--types", "--helicopter"}, "with --no-match", [&arguments] {
    return arguments.match;
  });
  command.add_option("--camera-pitch", arguments.camera_pitch_deg)
      ->description(
          "Degrees that the camera looks up, which says where light comes from (without: "
          "as much as has the aircraft most nearly level, 0 to 60)")
      ->check(CLI::Range(-90.0, 90.0));
}

}  // namespace

void add_compare(CLI::App& app, Context& context) {
  auto [command, arguments] = add_command(app, context, "compare", compare);
  command->description(
      "Put an aircraft beside a real one in its own clip, and measure how both look");
  command->add_option("--real", arguments->real, "Video with a real aircraft in it")->required();
  command->add_option("--boxes", arguments->boxes)
      ->description("Its boxes, which may be loose: frame,x,y,width,height (.csv)")
      ->required();
  command->add_option("--scene", arguments->scene)
      ->description(
          "Scene that says which aircraft, light, lens and camera model, and the rate of pictures; "
          "its video and path are not used, and its aircraft's type and attitude and its sun with "
          "--no-match alone")
      ->required();
  command->add_option("-o,--out", arguments->out, "Folder to make")->required();
  command->add_option("--origin", arguments->origin_px)
      ->description("What the boxes' first pixel is called (MATLAB: 1)")
      ->capture_default_str();
  add_match_options(*command, *arguments, context);
  command->add_flag("--overwrite", arguments->overwrite, "Replace the folder if it exists");
}

}  // namespace airtruth::cli
