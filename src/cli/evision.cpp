// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "cli/commands.h"
#include "comparison/evision/evision_table.h"
#include "foundation/base/files.h"
#include "foundation/run_files/run_files.h"

namespace airtruth::cli {
namespace {

struct EvisionArguments {
  std::string folder;
  std::string frames;
  bool level = false;
  bool still = false;
  bool overwrite = false;
  evision::EvisionOptions options;
};

constexpr const char* kHead =
    "sequence   frames  boxes  in view, no box   width px (off)        height px (off)       "
    "centre off, px\n"
    "                          theirs  ours      median                median                "
    "median   95 %\n";

std::string line(const evision::EvisionRow& row) {
  return fmt::format(
      "{:<10} {:>6} {:>6} {:>7} {:>5}    {:>5.0f} ({:>4.1f} px, {:>4.1f} %) {:>5.0f} ({:>4.1f} px, "
      "{:>4.1f} %) {:>7.1f} {:>6.1f}  {}",
      row.sequence,
      row.frames,
      row.published_boxes,
      row.without_box_published,
      row.without_box_ours,
      row.published_width_px,
      row.width_off_px,
      100 * row.width_off,
      row.published_height_px,
      row.height_off_px,
      100 * row.height_off,
      row.centre_off_px,
      row.centre_off_p95_px,
      row.sizes_hold() ? "" : "beyond 2 px and 10 %");
}

std::string csv_line(const evision::EvisionFramePair& pair) {
  const PixelBox& p = pair.published;
  const std::string ours =
      pair.ours
          ? fmt::format(
                "{},{},{},{}", pair.ours->x, pair.ours->y, pair.ours->width, pair.ours->height)
          : ",,,";
  return fmt::format(
      "{},{},{},{},{},{},{}\n", pair.sequence, pair.frame, ours, p.x, p.y, p.width, p.height);
}

void evision(EvisionArguments arguments, Context& context) {
  RunFiles()
      .reads(arguments.folder)
      .writes(arguments.frames, arguments.overwrite, {".csv"})
      .check();
  Console& console = context.console();
  arguments.options.bank = !arguments.level;
  arguments.options.recover_motion = !arguments.still;
  arguments.options.stop = context.stop;
  std::string frames =
      "sequence,frame,x,y,width,height,published_x,published_y,published_width,published_height\n";
  if (!arguments.frames.empty())
    arguments.options.each = [&frames](const evision::EvisionFramePair& pair) {
      frames += csv_line(pair);
    };
  const auto rows = evision::evision_table(arguments.folder, arguments.options, console.warn());
  if (!arguments.frames.empty()) write_file(arguments.frames, frames);
  console.result(fmt::format("B737 as {}, C172 as {}, scale {}, a spread of {} px\n",
                             arguments.options.airliner,
                             arguments.options.light_aircraft,
                             arguments.options.scale,
                             arguments.options.spread_px));
  std::string table = kHead;
  int theirs = 0;
  int ours = 0;
  int hold = 0;
  for (const auto& row : rows) {
    table += line(row) + "\n";
    theirs += row.without_box_published;
    ours += row.without_box_ours;
    hold += row.sizes_hold() ? 1 : 0;
  }
  console.result(table + fmt::format("\nsizes within 2 px or 10 % in the median: {} of {} "
                                     "sequences; in view without a box: {} "
                                     "of theirs, {} of ours",
                                     hold,
                                     rows.size(),
                                     theirs,
                                     ours));
}

}  // namespace

void add_evision(CLI::App& app, Context& context) {
  auto [command, arguments] = add_command(app, context, "evision", evision);
  command->description("Compare the published E-Vision annotations with boxes of our own");
  evision::EvisionOptions& options = arguments->options;
  command->add_option("DIR", arguments->folder, "Folder with groundtruth/*.xml and positions/*.csv")
      ->required();
  command->add_option("--airliner", options.airliner, "Aircraft of the B737 sequences")
      ->capture_default_str();
  command->add_option("--light-aircraft", options.light_aircraft, "Aircraft of the C172 sequences")
      ->capture_default_str();
  add_number(*command, "--scale", options.scale, 0.01, 100.0)->description("Scale both aircraft");
  add_number(*command, "--spread", options.spread_px, 0, 20)
      ->description("Pixels that the warps add to each side of a published box");
  command->add_option(
      "--frames", arguments->frames, "Also write every frame's two boxes here (.csv)");
  command->add_flag("--overwrite", arguments->overwrite, "Replace the file of --frames");
  command->add_flag("--still", arguments->still)
      ->description("Without the camera's motion, which moves and turns the published boxes");
  command->add_flag("--level", arguments->level, "Wings level, in place of banked turns");
}

}  // namespace airtruth::cli
