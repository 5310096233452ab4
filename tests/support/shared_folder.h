// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdlib>

namespace airtruth::test_support {

// The folder of real clips and public files that AIRTRUTH_SHARED names; nullptr where it is unset
// or empty.
inline const char* shared_folder() {
  const char* shared = std::getenv("AIRTRUTH_SHARED");
  return shared != nullptr && *shared != '\0' ? shared : nullptr;
}

}  // namespace airtruth::test_support
