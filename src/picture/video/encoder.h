// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "picture/video/libav.h"
#include "picture/video/reader.h"
#include "picture/video/writer.h"

// The encoder of an output format, and pictures in the form in which it takes them.
namespace airtruth::video {

// The colour that a format stores for the video's pictures. Throws Error where it can hold none of
// their colour and size.
image::Colour stored_colour(const StreamInfo& info,
                            Format format,
                            const std::filesystem::path& path);

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

// A frame of the encoder's size and pixel format with a copy of the picture, converted to the
// colour `stored`; in the memory of the encoder's device where it has one. Throws std::bad_alloc,
// and Error where the device takes no frame.
FramePtr copied_frame(const AVCodecContext& encoder,
                      const image::Picture& picture,
                      const image::Colour& stored,
                      Format format);

}  // namespace airtruth::video
