// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string_view>

#include "aircraft/texture_file/picture.h"

// Truevision TGA File Format 2.0.
namespace airtruth::texture_file {

// Empty where the header contradicts itself, since the format has no signature. Throws Error
// without a place.
std::optional<Picture> read_tga(std::string_view bytes, const PictureLimits& limits);

}  // namespace airtruth::texture_file
