// SPDX-License-Identifier: Apache-2.0
#include "cli/commands.h"

namespace airtruth::cli {

void add_evision(CLI::App&, Context&) {}

}  // namespace airtruth::cli
