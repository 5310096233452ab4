// SPDX-License-Identifier: Apache-2.0
#include "cli/commands.h"

namespace airtruth::cli {

// In the order of --help.
void add_commands(CLI::App& app, Context& context) {
  add_demo(app, context);
  add_render(app, context);
  add_scene(app, context);
  add_preview(app, context);
  add_studio(app, context);
  add_overlay(app, context);
  add_inspect(app, context);
  add_motion(app, context);
  add_calibrate(app, context);
  add_mask(app, context);
  add_lens(app, context);
  add_log(app, context);
  add_aircraft(app, context);
  add_synth(app, context);
  add_encounter(app, context);
  add_dataset(app, context);
  add_track(app, context);
  add_detect(app, context);
  add_evaluate(app, context);
  add_compare(app, context);
  add_evision(app, context);
  add_describe(app, context);
}

}  // namespace airtruth::cli
