// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string_view>

#include "aircraft/texture_file/picture.h"

// The formats that are read without a library; picture.h lists their kinds. Errors have no place.
namespace airtruth::texture_file {

// For what other bitmaps hold, the Error names their bits and compression.
Picture read_bmp(std::string_view bytes, const PictureLimits& limits);

Picture read_sgi(std::string_view bytes, const PictureLimits& limits);

// Empty where the header contradicts itself, since the format has no signature.
std::optional<Picture> read_tga(std::string_view bytes, const PictureLimits& limits);

}  // namespace airtruth::texture_file
