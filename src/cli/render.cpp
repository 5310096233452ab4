// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <memory>

#include "base/error.h"
#include "cli/commands.h"
#include "scene/scene.h"
#include "sequence/sequence.h"

namespace airtruth::cli {
namespace {

struct Arguments {
  std::string scene;
  std::string out = ".";
  bool overwrite = false;
  bool no_cache = false;
  int threads = 0;
  std::string gpu;
};

sequence::Options options_from(const Arguments& arguments, Context& context) {
  sequence::Options options;
  options.overwrite = arguments.overwrite;
  options.threads = arguments.threads;
  options.use_cache = !arguments.no_cache;
  if (arguments.gpu == "none") {
    options.software_gl = true;
  } else if (!arguments.gpu.empty()) {
    if (arguments.gpu.find_first_not_of("0123456789") != std::string::npos || arguments.gpu.size() > 3)
      throw Error("--gpu is '" + arguments.gpu + "'; expected a device number or none");
    options.gpu = std::stoi(arguments.gpu);
  }
  Console& console = context.console();
  options.warn = console.warn();
  options.stop = context.stop;
  options.progress = [&console](const sequence::Progress& progress) {
    console.progress("rendering", progress.frames_done, progress.frames_total);
  };
  return options;
}

void render(const Arguments& arguments, Context& context) {
  const scene::Scene scene = scene::read_scene(arguments.scene);
  const sequence::Summary summary = sequence::render(scene, arguments.out, options_from(arguments, context));
  context.console().result(fmt::format("{}: {} frames, an intruder visible in {}, {:.1f} s ({:.1f} frames/s)",
                                       summary.folder.string(), summary.frames, summary.frames_visible, summary.seconds,
                                       static_cast<double>(summary.frames) / std::max(1e-9, summary.seconds)));
}

}  // namespace

void add_render(CLI::App& app, Context& context) {
  auto* command = app.add_subcommand("render", "Put the scene's intruders into its video, with the truth of every frame");
  auto arguments = std::make_shared<Arguments>();
  command->add_option("SCENE", arguments->scene, "Scene file (.toml); examples/render.toml shows every key")->required();
  command->add_option("--out,-o", arguments->out, "Folder in which DIR/<name>/ is made (default: here)");
  command->add_flag("--overwrite", arguments->overwrite, "Replace the output folder where it exists");
  command->add_option("--threads,-j", arguments->threads, "Threads to use (default: all cores)")->check(CLI::Range(1, 1024));
  command->add_option("--gpu", arguments->gpu, "chroma-key's OpenGL device: a number, or none for llvmpipe");
  command->add_flag("--no-cache", arguments->no_cache, "Measure the camera's motion anew");
  command->callback([arguments, &context] { render(*arguments, context); });
}

}  // namespace airtruth::cli
