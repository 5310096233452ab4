// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "foundation/base/files.h"
#include "foundation/image/layer.h"
#include "foundation/image/picture.h"

namespace airtruth::video {

// A still image (png, jpg, bmp, tif, ...) as packed sRGB; an alpha channel is dropped. Throws
// Error.
image::Rgb8 read_still(const std::filesystem::path& path);

// Error where write_still() would fail for a reason that is there before the picture is: the path's
// ending, and what check_output_file() refuses. An empty path is no output and no error.
void check_still_output(const std::filesystem::path& path, bool overwrite);

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

// Grey samples as a .png of 8 bits, and back. `samples`: height rows of width. Throws Error.
struct Grey {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> samples;
};
std::string png_of(const Grey& grey);
Grey read_grey(const std::filesystem::path& path);

// An own-aircraft mask: darker than middle grey = own aircraft. Error if its size is not width x
// height, or if it is black all over.
image::Mask read_mask(const std::filesystem::path& path, int width, int height);

}  // namespace airtruth::video
