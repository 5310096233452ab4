// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "aircraft/texture_file/picture.h"

// Truevision TGA File Format 2.0. It has no signature: is_tga() is true for a header without
// contradictions. read_tga() throws Error without a place.
namespace airtruth::aircraft {

bool is_tga(std::string_view bytes);
Picture read_tga(std::string_view bytes, const PictureLimits& limits);

}  // namespace airtruth::aircraft
