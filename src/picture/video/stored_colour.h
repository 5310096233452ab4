// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "picture/video/libav.h"
#include "picture/video/writer.h"

// How an output format stores a picture: its colour, its pixel format, and the conversion to both.
namespace airtruth::video {

// The colour that a format stores for a picture of this colour. Throws Error where it stores none.
image::Colour stored_colour(const image::Colour& colour,
                            Format format,
                            const std::filesystem::path& path);

// Throws Error where a format cannot hold a picture of this size with this chroma.
void check_size(const StreamInfo& info,
                image::Chroma chroma,
                Format format,
                const std::filesystem::path& path);

AVPixelFormat pixel_format(const image::Colour& stored, Format format);

// Copies the picture, converted to the colour `stored`, to the buffers of a frame.
void fill_frame_as(AVFrame& frame,
                   const image::Picture& picture,
                   const image::Colour& stored,
                   Format format);

}  // namespace airtruth::video
