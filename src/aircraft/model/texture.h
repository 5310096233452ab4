// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aircraft/model/mesh.h"
#include "aircraft/texture_file/picture.h"

namespace airtruth::model {

// The linear value of an sRGB value, both 0..1, by the exact curve of IEC 61966-2-1.
float linear_channel(float srgb);

// A texture from a picture of sRGB with straight alpha. The texels are decoded to linear light and
// premultiplied, and then the mip chain is built by averaging.
Texture texture_from_picture(const texture_file::Picture& picture, bool repeat_u, bool repeat_v);

// The alpha of the full-size level at (u, v), interpolated bilinearly. Beyond 0..1 the texture
// repeats or its border continues, by repeat_u and repeat_v.
float alpha_at(const Texture& texture, float u, float v);

}  // namespace airtruth::model
