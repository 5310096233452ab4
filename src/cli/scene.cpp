// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cctype>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "cli/commands.h"
#include "foundation/base/files.h"
#include "foundation/base/text.h"
#include "foundation/run_files/run_files.h"
#include "picture/video/numbered_images.h"
#include "sequence/new_scene/new_scene.h"

namespace airtruth::cli {
namespace {

struct NewArguments {
  std::string video;
  std::string out;
  std::string lens;
  std::optional<double> frame_rate_hz;
  bool overwrite = false;
};

// The name of a file as it can be pasted into a shell, where one that begins with a dash would be
// an option.
std::string pasted(const std::string& file) {
  const std::string name = file.starts_with('-') ? "./" + file : file;
  const bool is_plain = std::ranges::all_of(name, [](unsigned char c) {
    return std::isalnum(c) != 0 ||
           std::string_view("._-/").find(static_cast<char>(c)) != std::string_view::npos;
  });
  return is_plain ? name : shell_word(name);
}

void new_scene(const NewArguments& arguments, Context& context) {
  const std::string out =
      !arguments.out.empty() ? arguments.out : video::clip_name(arguments.video) + ".toml";
  RunFiles()
      .reads(arguments.video)
      .reads(arguments.lens)
      .writes(out, arguments.overwrite, {".toml"})
      .check();
  Console& console = context.console();
  new_scene::NewSceneOptions options;
  if (!arguments.lens.empty()) options.lens = arguments.lens;
  options.picture_rate_hz = arguments.frame_rate_hz;
  options.folder = std::filesystem::absolute(out).parent_path();
  follow(options, context, "looking for lens and motion");
  const std::string text = new_scene::scene_text(arguments.video, options);
  console.end_progress();
  write_file(out, text);
  console.result(fmt::format("{}\nnext: airtruth preview {}", out, pasted(out)));
}

}  // namespace

void add_scene(CLI::App& app, Context& context) {
  auto* group = app.add_subcommand("scene", "Scene files");
  group->require_subcommand(1);
  auto [command, arguments] = add_command(*group, context, "new", new_scene);
  command->description("Write a commented scene for a video, with a first encounter");
  command
      ->add_option("VIDEO", arguments->video, "The onboard video, or a folder of numbered pictures")
      ->required();
  command->add_option("-o,--out", arguments->out)
      ->description("Scene file to write (default: the video's name with .toml, here)");
  command->add_option("--lens", arguments->lens, "Calibration (OpenCV or Gyroflow)");
  add_frame_rate(*command, arguments->frame_rate_hz);
  command->add_flag("--overwrite", arguments->overwrite, "Replace the file where it exists");
}

}  // namespace airtruth::cli
