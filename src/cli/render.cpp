// SPDX-License-Identifier: Apache-2.0
#include "sequence/pipeline/render.h"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "cli/commands.h"
#include "foundation/base/error.h"
#include "foundation/run_files/run_files.h"
#include "scene/scene/scene.h"

namespace airtruth::cli {
namespace {

struct RenderArguments : pipeline::Options {
  std::string scene;
  std::string out = ".";
  bool no_cache = false;
  bool timings = false;
  std::string device;
};

pipeline::Options options_from(const RenderArguments& arguments, Context& context) {
  pipeline::Options options = arguments;
  options.use_cache = !arguments.no_cache;
  const std::string& device = arguments.device;
  if (device == "none") {
    options.software_gl = true;
  } else if (!device.empty()) {
    if (device.find_first_not_of("0123456789") != std::string::npos || device.size() > 3)
      throw Error("--gpu is '" + device + "'; expected a device number or none");
    options.gpu = std::stoi(device);
  }
  Console& console = context.console();
  options.warn = console.warn();
  options.stop = context.stop;
  options.progress = [&console](const pipeline::Progress& progress) {
    console.progress(progress.stage, progress.frames_done, progress.frames_total);
  };
  return options;
}

// Each stage's CPU and wall time a frame, and the CPU time of the run's parts.
std::string timings(const pipeline::Summary& summary) {
  const pipeline::StageTimes& s = summary.stages;
  const double ms_per_frame =
      1000.0 / static_cast<double>(std::max<std::int64_t>(1, summary.frames));
  const auto stages = [&](double pipeline::StageTime::*time) {
    return fmt::format(
        "read {:.2f} ms, move {:.2f} ms, render {:.2f} ms, composite {:.2f} ms, write {:.2f} ms",
        s.read.*time * ms_per_frame,
        s.move.*time * ms_per_frame,
        s.render.*time * ms_per_frame,
        s.composite.*time * ms_per_frame,
        s.write.*time * ms_per_frame);
  };
  const double frames_s = s.read.cpu_s + s.move.cpu_s + s.render.cpu_s + s.composite.cpu_s +
                          s.write.cpu_s + s.other_threads_cpu_s;
  return fmt::format(
      "CPU time a frame: {}, codec and other threads {:.2f} ms\n"
      "wall time a frame: {}\n"
      "CPU time of the run: start {:.2f} s, frames {:.2f} s, end {:.2f} s",
      stages(&pipeline::StageTime::cpu_s),
      s.other_threads_cpu_s * ms_per_frame,
      stages(&pipeline::StageTime::wall_s),
      s.start_cpu_s,
      frames_s,
      s.end_cpu_s);
}

void render(const RenderArguments& arguments, Context& context) {
  const scene::Scene scene = scene::read_scene(arguments.scene);
  if (!arguments.device.empty() && scene.composite.method != scene::CompositeMethod::kChromaKey)
    throw Error("--gpu has no effect without method = \"chroma-key\"; leave it out");
  RunFiles()
      .reads(arguments.scene)
      .replaces(std::filesystem::path(arguments.out) / scene.name)
      .check();
  const pipeline::Summary summary =
      pipeline::render(scene, arguments.out, options_from(arguments, context));
  for (const std::string& note : summary.notes) context.console().result(note);
  const bool has_intruders = std::ranges::any_of(scene.intruders, scene::is_aircraft);
  context.console().result(
      fmt::format("{}: {} frames, {}, {:.1f} s ({:.1f} frames/s)",
                  summary.folder.string(),
                  summary.frames,
                  has_intruders ? fmt::format("an intruder visible in {}", summary.frames_visible)
                                : "no intruder",
                  summary.seconds,
                  static_cast<double>(summary.frames) / std::max(1e-9, summary.seconds)));
  if (arguments.timings) context.console().result(timings(summary));
}

}  // namespace

void add_render(CLI::App& app, Context& context) {
  auto [command, arguments] = add_command(app, context, "render", render);
  command->description("Put the scene's intruders into its video, with the truth of every frame");
  command->add_option("SCENE", arguments->scene)
      ->description("Scene file (.toml); examples/render.toml shows every key")
      ->required();
  command->add_option(
      "--out,-o", arguments->out, "Folder in which DIR/<name>/ is made (default: here)");
  command->add_flag(
      "--overwrite", arguments->overwrite, "Replace the output folder where it exists");
  command->add_option("--threads,-j", arguments->threads)
      ->description("Threads that make frames (default: all cores)")
      ->check(CLI::Range(1, 1024));
  command->add_option(
      "--gpu", arguments->device, "chroma-key's OpenGL device: a number, or none for llvmpipe");
  command->add_flag(
      "--timings", arguments->timings, "Also print the CPU and wall time of each stage");
  command->add_flag("--no-cache", arguments->no_cache)
      ->description("Measure the camera's motion and the aircraft's occlusion anew");
}

}  // namespace airtruth::cli
