// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "aircraft/texture_file/picture.h"

// The SGI Image File Format 0.97 (Paul Haeberli). read_sgi() throws Error without a place.
namespace airtruth::texture_file {

Picture read_sgi(std::string_view bytes, const PictureLimits& limits);

}  // namespace airtruth::texture_file
