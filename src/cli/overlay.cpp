// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "cli/commands.h"
#include "foundation/base/files.h"
#include "foundation/run_files/run_files.h"
#include "picture/video/still.h"
#include "sequence/replay/finished.h"

namespace airtruth::cli {
namespace {

struct OverlayArguments {
  std::string folder;
  std::string out;
  bool overwrite = false;
};

void overlay(const OverlayArguments& arguments, Context& context) {
  RunFiles files;
  files.reads(arguments.folder).writes(arguments.out, arguments.overwrite);
  const replay::Finished finished = replay::open_finished(arguments.folder);
  files.begin();
  Console& console = context.console();
  replay::OverlayOptions options;
  follow(options, context, "overlay");
  files.write(arguments.out,
              [&](const fs::path& at) { replay::write_overlay(finished, at, options); });
  files.commit();
  console.result(fmt::format("{}: {} frames", arguments.out, finished.truth.frames.size()));
}

struct InspectArguments {
  std::string folder;
  std::string out;
  std::string intruder;
  std::int64_t frame = 0;
  int zoom = 8;
  bool overwrite = false;
};

void inspect(const InspectArguments& arguments, Context& context) {
  video::check_still_output(arguments.out, arguments.overwrite);
  RunFiles().reads(arguments.folder).writes(arguments.out, arguments.overwrite).check();
  const replay::Finished finished = replay::open_finished(arguments.folder);
  video::write_still(
      arguments.out,
      replay::inspect(finished, arguments.frame, arguments.intruder, arguments.zoom));
  context.console().result(arguments.out);
}

}  // namespace

void add_overlay(CLI::App& app, Context& context) {
  auto [command, arguments] = add_command(app, context, "overlay", overlay);
  command->description("Burn boxes, range and id into a copy of a finished video");
  command->add_option("DIR", arguments->folder, "A folder that `airtruth render` has finished")
      ->required();
  command->add_option("-o,--out", arguments->out, "The video to write (.mp4, .mkv or .avi)")
      ->required();
  command->add_flag("--overwrite", arguments->overwrite, "Replace the file where it exists");
}

void add_inspect(CLI::App& app, Context& context) {
  auto [command, arguments] = add_command(app, context, "inspect", inspect);
  command->description("Show a frame's intruder: background, alpha and result, enlarged");
  command->add_option("DIR", arguments->folder, "A folder that `airtruth render` has finished")
      ->required();
  command->add_option("--frame", arguments->frame, "Frame number, from 0")->required();
  command->add_option("-o,--out", arguments->out, "The picture to write (.png or .jpg)")
      ->required();
  command->add_option("--intruder", arguments->intruder, "Its id (default: the first in view)");
  command->add_option("--zoom", arguments->zoom)
      ->description("Enlargement (default 8); less where the picture would pass 4000 px")
      ->check(CLI::Range(1, 64));
  command->add_flag("--overwrite", arguments->overwrite, "Replace the file where it exists");
}

}  // namespace airtruth::cli
