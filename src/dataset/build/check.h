// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>

#include "dataset/catalogue/catalogue.h"
#include "foundation/base/files.h"

namespace airtruth::build {

// Checks the inputs of a catalogue on this machine before any work begins. Aircraft must be known
// and videos must exist. Each background's mask, lens, camera file and path must be readable and
// must fit its video and the catalogue's method. No two sequences may have the same name. Throws
// Error at the line of the catalogue.
void check_sources(const catalogue::Catalogue& catalogue);

// The catalogue with these videos, by the background's name, in place of its own; the masks of
// these backgrounds are left out. Throws Error for a background that the catalogue lacks.
catalogue::Catalogue with_videos(catalogue::Catalogue catalogue,
                                 const std::map<std::string, fs::path>& videos);

}  // namespace airtruth::build
