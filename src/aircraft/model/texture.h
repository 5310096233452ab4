// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "aircraft/model/mesh.h"
#include "aircraft/texture_file/picture.h"

namespace airtruth::aircraft {

// sRGB, 0..1, to linear by the exact curve of IEC 61966-2-1.
float linear_channel(float srgb);

// A texture from straight-alpha sRGB texels (0..1, row 0 at the bottom): decoded, premultiplied,
// with its mip chain.
Texture texture_from_srgb(
    int width, int height, std::vector<std::array<float, 4>> texels, bool repeat_u, bool repeat_v);

// The same from 8-bit pixels.
Texture texture_from_picture(const Picture& picture, bool repeat_u, bool repeat_v);

// Alpha of the full-size level, bilinear, at (u, v).
float alpha_at(const Texture& texture, float u, float v);

}  // namespace airtruth::aircraft
