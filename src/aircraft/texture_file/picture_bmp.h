// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "aircraft/texture_file/picture.h"

// Windows bitmaps (BMP) of 8 bits with a palette, 24 and 32 bits, without compression. read_bmp()
// throws Error without a place; for what other bitmaps hold, it names their bits and compression.
namespace airtruth::texture_file {

Picture read_bmp(std::string_view bytes, const PictureLimits& limits);

}  // namespace airtruth::texture_file
