// SPDX-License-Identifier: Apache-2.0
// Scenes to begin: as a file, and on the page of the studio.
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <optional>
#include <string>

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <unistd.h>

#include "cli/commands.h"
#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/base/text.h"
#include "foundation/run_files/run_files.h"
#include "picture/video/numbered_images.h"
#include "sequence/new_scene/new_scene.h"
#include "studio/document/document.h"
#include "studio/server/server.h"
#include "studio/session/session.h"

namespace airtruth::cli {
namespace {

// A video, and what it does not state of its camera.
struct Input {
  std::string file;
  std::string lens;
  std::optional<double> frame_rate_hz;
};

// The text of a first scene for a video, which is to be written to `file`.
std::string first_scene(const Input& video,
                        const fs::path& file,
                        bool has_encounter,
                        Context& context) {
  new_scene::NewSceneOptions options;
  if (!video.lens.empty()) options.lens = video.lens;
  options.picture_rate_hz = video.frame_rate_hz;
  options.folder = fs::absolute(file).parent_path();
  options.has_encounter = has_encounter;
  follow(options, context, "looking for lens and motion");
  std::string text = new_scene::scene_text(video.file, options);
  context.console().end_progress();
  return text;
}

struct NewArguments : Input {
  std::string out;
  bool overwrite = false;
};

void new_scene(const NewArguments& arguments, Context& context) {
  const std::string out =
      !arguments.out.empty() ? arguments.out : video::clip_name(arguments.file) + ".toml";
  RunFiles()
      .reads(arguments.file)
      .reads(arguments.lens)
      .writes(out, arguments.overwrite, {".toml"})
      .check();
  write_file(out, first_scene(arguments, out, true, context));
  context.console().result(fmt::format("{}\nnext: airtruth preview {}", out, pasted(out)));
}

// Its file is a scene or a video.
struct StudioArguments : Input {
  std::string out = "out";
  int port = 0;
  bool open = false;
};

// The scene file; for a video that of its name in the folder where the command runs.
fs::path scene_file(const fs::path& input) {
  if (input.extension() == ".toml") return input;
  return video::clip_name(input) + ".toml";
}

std::unique_ptr<document::Document> document_of(const StudioArguments& arguments,
                                                const fs::path& file,
                                                Context& context) {
  Console& console = context.console();
  std::optional<std::string> begun;
  if (file != arguments.file && !fs::exists(file))
    begun = first_scene(arguments, file, false, context);
  else if (file != arguments.file)
    console.warning(fmt::format("{} is there and is opened", file.string()));
  auto document = std::make_unique<document::Document>(file, std::move(begun), console.warn());
  if (!document->scene()) console.warning(document->problem());
  return document;
}

// Begins the user's browser, which is not waited for. It takes no signal mask of ours, and says
// nothing on this terminal.
void open_in_browser(const std::string& address, Console& console) {
  std::string program = "xdg-open";
  std::string word = address;
  char* arguments[] = {program.data(), word.data(), nullptr};
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  for (const int file : {0, 1, 2})
    posix_spawn_file_actions_addopen(&files, file, "/dev/null", O_RDWR, 0);
  posix_spawn_file_actions_addclosefrom_np(&files, 3);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t none;
  sigemptyset(&none);
  sigset_t pipe = none;
  sigaddset(&pipe, SIGPIPE);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setsigdefault(&attributes, &pipe);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
  pid_t child = 0;
  const int fault = posix_spawnp(&child, program.c_str(), &files, &attributes, arguments, environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&files);
  if (fault != 0)
    console.warning("xdg-open is not there (package xdg-utils); open the address yourself");
}

void studio(const StudioArguments& arguments, Context& context) {
  Console& console = context.console();
  const fs::path file = scene_file(arguments.file);
  auto document = document_of(arguments, file, context);
  server::Options where;
  where.port = static_cast<std::uint16_t>(arguments.port);
  // For work on the page.
  if (const char* page = std::getenv("AIRTRUTH_STUDIO_PAGE")) where.page = page;
  server::Server server(where);
  session::Options how;
  how.out = arguments.out;
  session::Session session(std::move(document), how, server.ways());
  console.print(server.address() + "\n");
  if (arguments.open) open_in_browser(server.address(), console);
  server.run(session, context.stop);
  console.ended("ended; steps that are not saved are kept for the next start");
  throw Interrupted();
}

}  // namespace

void add_scene(CLI::App& app, Context& context) {
  auto* group = app.add_subcommand("scene", "Scene files");
  group->require_subcommand(1);
  auto [command, arguments] = add_command(*group, context, "new", new_scene);
  command->description("Write a commented scene for a video, with a first encounter");
  command
      ->add_option("VIDEO", arguments->file, "The onboard video, or a folder of numbered pictures")
      ->required();
  command->add_option("-o,--out", arguments->out)
      ->description("Scene file to write (default: the video's name with .toml, here)");
  command->add_option("--lens", arguments->lens, "Calibration file (docs/lenses.md)");
  add_frame_rate(*command, arguments->frame_rate_hz);
  command->add_flag("--overwrite", arguments->overwrite, "Replace the file where it exists");
}

void add_studio(CLI::App& app, Context& context) {
  auto [command, arguments] = add_command(app, context, "studio", studio);
  command->description("Place aircraft by hand on the video, in a browser's page");
  command->add_option("SCENE|VIDEO", arguments->file)
      ->description(
          "Scene file (.toml), or an onboard video, for which one of its name is begun "
          "here, or opened where it exists")
      ->required();
  command->add_option(
      "-o,--out", arguments->out, "Folder of the videos that the page renders [out]");
  command->add_option("--lens", arguments->lens)
      ->description("For a video: calibration file of its camera (docs/lenses.md)");
  add_frame_rate(*command, arguments->frame_rate_hz);
  const std::string& input = arguments->file;
  expect_effect(context, *command, {"--lens", "--frame-rate"}, "on a scene", [&input] {
    return scene_file(input) != input;
  });
  command->add_option("--port", arguments->port, "Port of 127.0.0.1; 0: any that is free [0]")
      ->check(CLI::Range(0, 65535));
  command->add_flag("--open", arguments->open, "Open the page in the browser");
}

}  // namespace airtruth::cli
