// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "dataset/catalogue/catalogue.h"

namespace airtruth::dataset {

// What a catalogue names is at hand on this machine, so that a slip of the pen is said before any
// work is done: aircraft are known, videos exist (but for the backgrounds in `videos`, for which
// those stand), each background's mask, lens, camera file and path can be read and go with its
// video and with the catalogue's method, and no two sequences have one name. Throws Error at the
// line.
void check_sources(const Catalogue& catalogue, const std::map<std::string, fs::path>& videos);

}  // namespace airtruth::dataset
