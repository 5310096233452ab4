// SPDX-License-Identifier: Apache-2.0
#include "cli/commands.h"

namespace airtruth::cli {

void add_commands(CLI::App& app, Context& context) { add_demo(app, context); }

}  // namespace airtruth::cli
