// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "foundation/base/files.h"
#include "foundation/image/layer.h"
#include "foundation/image/picture.h"

namespace airtruth::video {

// Reads a still image (png, jpg, bmp, tif, ...) as packed sRGB. An alpha channel is dropped. Throws
// Error.
image::Rgb8 read_still(const std::filesystem::path& path);

// Width and height of a still image, from its header where libav finds them there. Throws Error.
std::pair<int, int> size_of_still(const std::filesystem::path& path);

// Throws Error where write_still() would fail for a reason that does not depend on the picture: the
// path's ending, and what check_output_file() refuses. An empty path means no output and is no
// error.
void check_still_output(const std::filesystem::path& path, bool overwrite);

// Writes .png (lossless) or .jpg, by the path's extension. The file is written whole or not at all.
// Throws Error.
void write_still(const std::filesystem::path& path,
                 const image::Rgb8& rgb,
                 Flush flush = Flush::kNow);

// Writes a decoded picture in the same way; a .jpg keeps its halved chroma.
void write_still(const std::filesystem::path& path,
                 const image::Picture& picture,
                 Flush flush = Flush::kNow);

// The bytes of such a .jpg, with a quality from 1 (best) to 31.
std::string jpeg_of(const image::Rgb8& rgb, int quality = 3);

// Grey samples as a .png of 8 bits, and the reverse. `samples`: height rows of width. Throws Error.
struct Grey {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> samples;
};
std::string png_of(const Grey& grey);
Grey read_grey(const std::filesystem::path& path);

// Reads an own-aircraft mask: values darker than middle grey are the own aircraft. Error where its
// size is not width x height, or where it is black all over.
image::Mask read_mask(const std::filesystem::path& path, int width, int height);

}  // namespace airtruth::video
