// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "aircraft/texture_file/picture.h"

// One reader per format, for picture.cpp only. Each throws Error without a place.
namespace airtruth::aircraft {

bool is_png(std::string_view bytes);
bool is_jpeg(std::string_view bytes);
bool is_sgi(std::string_view bytes);
bool is_tga(std::string_view bytes);  // TGA has no signature: a header without contradictions

Picture read_png(std::string_view bytes, const PictureLimits& limits);
Picture read_jpeg(std::string_view bytes, const PictureLimits& limits);
Picture read_sgi(std::string_view bytes, const PictureLimits& limits);
Picture read_tga(std::string_view bytes, const PictureLimits& limits);

// A black picture of that size. Throws Error, which names the exceeded limit, for a larger one.
Picture blank_picture(std::uint64_t width, std::uint64_t height, const PictureLimits& limits);

}  // namespace airtruth::aircraft
