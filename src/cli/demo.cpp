// SPDX-License-Identifier: Apache-2.0
#include "sequence/demo/demo.h"

#include <fmt/format.h>

#include "cli/commands.h"
#include "sequence/pipeline/render.h"

namespace airtruth::cli {
namespace {

struct DemoArguments {
  std::string out = "demo";
  demo::DemoOptions demo;
};

void demo(DemoArguments arguments, Context& context) {
  Console& console = context.console();
  pipeline::Options& run = arguments.demo.run;
  run.stop = context.stop;
  run.warn = console.warn();
  run.progress = [&console](const pipeline::Progress& p) {
    console.progress(p.stage, p.frames_done, p.frames_total);
  };
  const pipeline::Summary summary = demo::make_demo(arguments.out, arguments.demo);
  console.result(fmt::format("{}: {} frames, an intruder visible in {}",
                             summary.folder.string(),
                             summary.frames,
                             summary.frames_visible));
}

}  // namespace

void add_demo(CLI::App& app, Context& context) {
  auto [command, arguments] = add_command(app, context, "demo", demo);
  command->description(
      "From nothing: a virtual flight, an aircraft put into it, its truth and an overlay");
  command->add_option("--out,-o", arguments->out, "Folder to make")->capture_default_str();
  command->add_option("--seed", arguments->demo.seed, "Another flight")->capture_default_str();
  add_number(*command, "--frames", arguments->demo.frame_count, 2, 100000)->description("Length");
  command->add_flag(
      "--overwrite", arguments->demo.run.overwrite, "Replace the folder's files where they exist");
}

}  // namespace airtruth::cli
