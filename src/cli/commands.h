// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <stop_token>

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
using Action = std::function<void()>;

void add_render(CLI::App& app, Context& context);
void add_scene(CLI::App& app, Context& context);
void add_preview(CLI::App& app, Context& context);
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
void add_dataset_exchange(CLI::App& group, Context& context);  // `dataset export` and `import`
void add_track(CLI::App& app, Context& context);
void add_detect(CLI::App& app, Context& context);
void add_evaluate(CLI::App& app, Context& context);
void add_compare(CLI::App& app, Context& context);
void add_judge(CLI::App& app, Context& context);
void add_encounter(CLI::App& app, Context& context);
void add_encounter_sample(CLI::App& group, Context& context);  // `encounter sample`
void add_demo(CLI::App& app, Context& context);
void add_describe(CLI::App& app, Context& context);

}  // namespace airtruth::cli
