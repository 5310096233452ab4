// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>

namespace airtruth::cli {

// The width and height of "1280x960", as --size takes them; Error for anything else.
std::pair<int, int> size_from(const std::string& text);

}  // namespace airtruth::cli
