// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

namespace airtruth {

// The library never prints: it passes one-line warnings to its caller through this function. An
// empty function discards them.
using Warn = std::function<void(const std::string& message)>;

inline void warn(const Warn& to, const std::string& message) {
  if (to) to(message);
}

}  // namespace airtruth
