// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <stop_token>
#include <string>
#include <type_traits>
#include <utility>

#include <CLI/CLI.hpp>

#include "cli/console.h"

// One function per subcommand: it declares its arguments on `app` and returns the action to run
// after they are parsed.
namespace airtruth::cli {

struct Context {
  // Creates the console after parsing, when --quiet and --json-log are known.
  std::function<Console&()> console;
  std::stop_token stop;
  // Exit code of a command that finished its work and has faults to report.
  int exit_code = 0;
};

// Declares a command that calls run(arguments, context) after its arguments are parsed. Returns the
// command, and the arguments that its options are to set.
template <typename Parameter>
std::pair<CLI::App*, std::remove_cvref_t<Parameter>*> add_command(CLI::App& group,
                                                                  Context& context,
                                                                  const char* name,
                                                                  const char* about,
                                                                  void (*run)(Parameter,
                                                                              Context&)) {
  CLI::App* command = group.add_subcommand(name, about);
  auto arguments = std::make_shared<std::remove_cvref_t<Parameter>>();
  command->callback([run, arguments, &context] { run(*arguments, context); });
  return {command, arguments.get()};
}

// Shows the warnings of a stage and its progress, and lets an interrupt stop it.
template <typename Options>
void follow(Options& options, Context& context, const char* stage, const char* unit = "frames") {
  Console& console = context.console();
  if constexpr (requires { options.warn; }) options.warn = console.warn();
  options.stop = context.stop;
  options.progress = [&console, stage, unit](std::int64_t done, std::int64_t total) {
    console.progress(stage, done, total, unit);
  };
}

// --jobs, of what works on several sequences or files at a time.
inline void add_jobs(CLI::App& command, int& jobs, const char* about) {
  command.add_option("--jobs,-j", jobs, about)->check(CLI::Range(1, 1024));
}

// Reads the width and height from "1280x960", the form of --size. Throws Error for any other form.
std::pair<int, int> size_from(const std::string& text);

void add_render(CLI::App& app, Context& context);
void add_scene(CLI::App& app, Context& context);
void add_preview(CLI::App& app, Context& context);
void add_studio(CLI::App& app, Context& context);
void add_motion(CLI::App& app, Context& context);
void add_calibrate(CLI::App& app, Context& context);
void add_lens(CLI::App& app, Context& context);
void add_log(CLI::App& app, Context& context);
void add_mask(CLI::App& app, Context& context);
void add_aircraft(CLI::App& app, Context& context);
void add_overlay(CLI::App& app, Context& context);
void add_inspect(CLI::App& app, Context& context);
void add_synth(CLI::App& app, Context& context);
void add_evision(CLI::App& app, Context& context);
void add_dataset(CLI::App& app, Context& context);
void add_track(CLI::App& app, Context& context);
void add_detect(CLI::App& app, Context& context);
void add_evaluate(CLI::App& app, Context& context);
void add_compare(CLI::App& app, Context& context);
void add_encounter(CLI::App& app, Context& context);
void add_demo(CLI::App& app, Context& context);
void add_describe(CLI::App& app, Context& context);

}  // namespace airtruth::cli
