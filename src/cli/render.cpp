// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <memory>

#include <fmt/format.h>

#include "cli/commands.h"
#include "foundation/base/error.h"
#include "sequence/sequence/sequence.h"
#include "world/scene/scene.h"

namespace airtruth::cli {
namespace {

struct RenderArguments {
  std::string scene;
  std::string out = ".";
  bool overwrite = false;
  bool no_cache = false;
  bool timings = false;
  int threads = 0;
  std::string gpu;
};

sequence::Options options_from(const RenderArguments& arguments, Context& context) {
  sequence::Options options;
  options.overwrite = arguments.overwrite;
  options.threads = arguments.threads;
  options.use_cache = !arguments.no_cache;
  if (arguments.gpu == "none") {
    options.software_gl = true;
  } else if (!arguments.gpu.empty()) {
    if (arguments.gpu.find_first_not_of("0123456789") != std::string::npos ||
        arguments.gpu.size() > 3)
      throw Error("--gpu is '" + arguments.gpu + "'; expected a device number or none");
    options.gpu = std::stoi(arguments.gpu);
  }
  Console& console = context.console();
  options.warn = console.warn();
  options.stop = context.stop;
  options.progress = [&console](const sequence::Progress& progress) {
    console.progress(progress.stage, progress.frames_done, progress.frames_total);
  };
  return options;
}

std::string stages(const sequence::Summary& summary) {
  const sequence::StageSeconds& s = summary.stages;
  const double per_frame = 1000.0 / static_cast<double>(std::max<std::int64_t>(1, summary.frames));
  return fmt::format(
      "time a frame: read {:.2f} ms, move {:.2f} ms, render {:.2f} ms, composite {:.2f} ms, write "
      "{:.2f} ms",
      s.read * per_frame,
      s.move * per_frame,
      s.render * per_frame,
      s.composite * per_frame,
      s.write * per_frame);
}

void render(const RenderArguments& arguments, Context& context) {
  const scene::Scene scene = scene::read_scene(arguments.scene);
  const sequence::Summary summary =
      sequence::render(scene, arguments.out, options_from(arguments, context));
  context.console().result(
      fmt::format("{}: {} frames, an intruder visible in {}, {:.1f} s ({:.1f} frames/s)",
                  summary.folder.string(),
                  summary.frames,
                  summary.frames_visible,
                  summary.seconds,
                  static_cast<double>(summary.frames) / std::max(1e-9, summary.seconds)));
  if (arguments.timings) context.console().result(stages(summary));
}

}  // namespace

void add_render(CLI::App& app, Context& context) {
  auto* command = app.add_subcommand(
      "render", "Put the scene's intruders into its video, with the truth of every frame");
  auto arguments = std::make_shared<RenderArguments>();
  command
      ->add_option(
          "SCENE", arguments->scene, "Scene file (.toml); examples/render.toml shows every key")
      ->required();
  command->add_option(
      "--out,-o", arguments->out, "Folder in which DIR/<name>/ is made (default: here)");
  command->add_flag(
      "--overwrite", arguments->overwrite, "Replace the output folder where it exists");
  command->add_option("--threads,-j", arguments->threads, "Threads to use (default: all cores)")
      ->check(CLI::Range(1, 1024));
  command->add_option(
      "--gpu", arguments->gpu, "chroma-key's OpenGL device: a number, or none for llvmpipe");
  command->add_flag("--timings", arguments->timings, "Also print where the time went, by stage");
  command->add_flag("--no-cache",
                    arguments->no_cache,
                    "Measure the camera's motion and the aircraft's openness anew");
  command->callback([arguments, &context] { render(*arguments, context); });
}

}  // namespace airtruth::cli
