// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>

namespace airtruth::cli {

// Reads the width and height from "1280x960", the form of --size. Throws Error for any other form.
std::pair<int, int> size_from(const std::string& text);

}  // namespace airtruth::cli
