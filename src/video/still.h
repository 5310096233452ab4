// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "base/files.h"
#include "image/layer.h"
#include "image/picture.h"

namespace airtruth::video {

// A still image (png, jpg, bmp, tif, ...) as packed sRGB; an alpha channel is dropped. Throws
// Error.
image::Rgb8 read_still(const std::filesystem::path& path);

// By extension: .png (lossless) or .jpg. Whole or not at all. Throws Error.
void write_still(const std::filesystem::path& path,
                 const image::Rgb8& rgb,
                 Flush flush = Flush::kNow);

// The same of a decoded picture; a .jpg keeps its halved chroma.
void write_still(const std::filesystem::path& path,
                 const image::Picture& picture,
                 Flush flush = Flush::kNow);

// The bytes of such a .jpg; quality from 1 (best) to 31.
std::string jpeg_of(const image::Rgb8& rgb, int quality = 3);

// An own-aircraft mask: darker than middle grey = own aircraft. Error if its size is not width x
// height, or if it is black all over.
image::Mask read_mask(const std::filesystem::path& path, int width, int height);

}  // namespace airtruth::video
