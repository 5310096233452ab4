// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include <fmt/format.h>

#include "cli/commands.h"
#include "foundation/base/error.h"
#include "foundation/base/files.h"
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
  const replay::Finished finished = replay::open_finished(arguments.folder);
  Console& console = context.console();
  replay::OverlayOptions options;
  options.overwrite = arguments.overwrite;
  options.stop = context.stop;
  options.progress = [&console](std::int64_t done, std::int64_t total) {
    console.progress("overlay", done, total);
  };
  replay::write_overlay(finished, arguments.out, options);
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
  const replay::Finished finished = replay::open_finished(arguments.folder);
  video::write_still(
      arguments.out,
      replay::inspect(finished, arguments.frame, arguments.intruder, arguments.zoom));
  context.console().result(arguments.out);
}

}  // namespace

void add_overlay(CLI::App& app, Context& context) {
  auto* command =
      app.add_subcommand("overlay", "Burn boxes, range and id into a copy of a finished video");
  auto arguments = std::make_shared<OverlayArguments>();
  command->add_option("DIR", arguments->folder, "A folder that `airtruth render` has finished")
      ->required();
  command->add_option("-o,--out", arguments->out, "The video to write (.mp4, .mkv or .avi)")
      ->required();
  command->add_flag("--overwrite", arguments->overwrite, "Replace the file where it exists");
  command->callback([arguments, &context] { overlay(*arguments, context); });
}

void add_inspect(CLI::App& app, Context& context) {
  auto* command = app.add_subcommand(
      "inspect", "Show a frame's intruder: background, alpha and result, enlarged");
  auto arguments = std::make_shared<InspectArguments>();
  command->add_option("DIR", arguments->folder, "A folder that `airtruth render` has finished")
      ->required();
  command->add_option("--frame", arguments->frame, "Frame number, from 0")->required();
  command->add_option("-o,--out", arguments->out, "The picture to write (.png or .jpg)")
      ->required();
  command->add_option("--intruder", arguments->intruder, "Its id (default: the first in view)");
  command->add_option("--zoom", arguments->zoom, "Enlargement (default 8)")
      ->check(CLI::Range(1, 64));
  command->add_flag("--overwrite", arguments->overwrite, "Replace the file where it exists");
  command->callback([arguments, &context] { inspect(*arguments, context); });
}

}  // namespace airtruth::cli
