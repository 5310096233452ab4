// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <airtruth/error.h>

namespace airtruth {

// Passes a warning to the caller's function for warnings; does nothing where the caller gave none.
inline void warn(const Warn& to, const std::string& message) {
  if (to) to(message);
}

}  // namespace airtruth
