// SPDX-License-Identifier: Apache-2.0
#include "sequence/preview/preview.h"

#include <chrono>
#include <filesystem>
#include <thread>

#include <fmt/format.h>

#include "cli/commands.h"
#include "foundation/base/error.h"
#include "foundation/run_files/run_files.h"
#include "picture/video/still.h"
#include "scene/scene/scene.h"
#include "sequence/pipeline/resolved_scene.h"
#include "sequence/setup/motion_source.h"

namespace airtruth::cli {
namespace {

struct PreviewArguments {
  std::string scene;
  std::string out = "preview.png";
  bool watch = false;
  bool motion = false;
};

void draw(const PreviewArguments& arguments, pipeline::Options options, Context& context) {
  Console& console = context.console();
  const scene::Scene scene = scene::read_scene(arguments.scene);
  RunFiles files;
  files.reads(arguments.scene);
  for (const std::filesystem::path& file : setup::files_read(scene)) files.reads(file);
  files.writes(arguments.out, true).check();
  if (arguments.motion) {
    options.progress = [&console](const pipeline::Progress& progress) {
      console.progress(
          "measuring the camera's motion", progress.frames_done, progress.frames_total);
    };
    pipeline::measure_ahead(scene, options);
    console.end_progress();
  }
  const auto made = preview::preview_of(scene, options);
  video::write_still(arguments.out, made.picture, Flush::kLater);
  std::string text = preview::table_text(made.rows);
  for (const std::string& line : made.approaches) text += line + "\n";
  for (const std::string& note : made.notes) text += note + "\n";
  console.result(text + arguments.out);
}

// The time of the last change; the epoch while an editor has the file replaced.
std::filesystem::file_time_type changed(const std::string& file) {
  std::error_code error;
  const auto time = std::filesystem::last_write_time(file, error);
  return error ? std::filesystem::file_time_type{} : time;
}

// Draws anew whenever the scene file is saved, until the user interrupts. A fault of the scene is
// said, and the picture stays as it was.
void watch(const PreviewArguments& arguments, const pipeline::Options& options, Context& context) {
  using namespace std::chrono_literals;
  if (!std::filesystem::is_regular_file(arguments.scene))
    throw Error("is not there; expected a scene file to watch", {arguments.scene});
  std::filesystem::file_time_type drawn{};
  while (!context.stop.stop_requested()) {
    const auto now = changed(arguments.scene);
    if (now == drawn || now == std::filesystem::file_time_type{}) {
      std::this_thread::sleep_for(100ms);
      continue;
    }
    drawn = now;
    try {
      draw(arguments, options, context);
    } catch (const Error& error) {
      context.console().error(error.what());
    }
  }
  throw Interrupted();
}

void preview(const PreviewArguments& arguments, Context& context) {
  video::check_still_output(arguments.out, true);
  pipeline::Options options;
  options.warn = context.console().warn();
  options.stop = context.stop;
  options.shared = pipeline::inputs_of(options);
  arguments.watch ? watch(arguments, options, context) : draw(arguments, options, context);
}

}  // namespace

void add_preview(CLI::App& app, Context& context) {
  auto [command, arguments] = add_command(app, context, "preview", preview);
  command->description("Show where a scene's intruders will be, without rendering the clip");
  command->add_option("SCENE", arguments->scene, "Scene file (.toml)")->required();
  command->add_option("-o,--out", arguments->out)
      ->description("The picture to write (.png or .jpg), replaced where it exists [preview.png]");
  command->add_flag("--motion", arguments->motion)
      ->description(
          "Measure the camera's motion first, a pass over the clip that is kept for later, "
          "and show each moment as it will be rendered. Without it a motion that is kept "
          "is used, and else none is shown");
  command->add_flag("--watch", arguments->watch, "Draw anew whenever the scene file is saved");
}

}  // namespace airtruth::cli
