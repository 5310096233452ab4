// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "picture/video/libav.h"
#include "picture/video/writer.h"

// Opens the encoder of an output format.
namespace airtruth::video {

// What an encoder must know of the video.
struct EncoderInput {
  StreamInfo info;
  image::Colour stored;  // stored_colour()
  // True where the container keeps the codec's header apart from the packets.
  bool has_global_header = false;
};

// An open encoder: libx264 or what WriterOptions::encoder says for mp4, FFV1 for mkv, MJPEG for
// avi. Throws Error at `path`, or at WriterOptions::encoder_where where the named encoder of H.264
// cannot be opened on this machine.
CodecPtr open_encoder(const EncoderInput& input,
                      const WriterOptions& options,
                      const std::filesystem::path& path);

}  // namespace airtruth::video
