// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "aircraft/model/mesh.h"
#include "aircraft/texture_file/picture.h"

namespace airtruth::aircraft {

// The linear value of an sRGB value, both 0..1, by the exact curve of IEC 61966-2-1.
float linear_channel(float srgb);

// A texture from texels of sRGB with straight alpha, all 0..1: width * height texels, row by row
// from the bottom of the picture. The texels are decoded to linear light and premultiplied, and
// then the mip chain is built by averaging.
Texture texture_from_srgb(
    int width, int height, std::vector<std::array<float, 4>> texels, bool repeat_u, bool repeat_v);

// The same from a picture of 8-bit sRGB.
Texture texture_from_picture(const Picture& picture, bool repeat_u, bool repeat_v);

// The alpha of the full-size level at (u, v), interpolated bilinearly. Beyond 0..1 the texture
// repeats or its border continues, by repeat_u and repeat_v.
float alpha_at(const Texture& texture, float u, float v);

}  // namespace airtruth::aircraft
