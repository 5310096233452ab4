// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdlib>
#include <filesystem>

namespace airtruth::test_support {

// The root of the source tree: AIRTRUTH_SOURCE_DIR, which ctest sets, or else the current folder.
// It is no constant of the compiler, so that objects do not differ between two clones (ccache).
inline std::filesystem::path source_folder() {
  const char* folder = std::getenv("AIRTRUTH_SOURCE_DIR");
  return folder != nullptr ? folder : ".";
}

}  // namespace airtruth::test_support
