// SPDX-License-Identifier: Apache-2.0
#pragma once

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/display.h>
#include <libavutil/imgutils.h>
#include <libavutil/opt.h>
#include <libavutil/pixdesc.h>
#include <libavutil/video_enc_params.h>
#include <libswscale/swscale.h>
}

#include <memory>
#include <optional>
#include <string>

#include "foundation/image/picture.h"
#include "picture/video/reader.h"

// libav's C objects as values, and its pixel formats as ours. Only this module includes it.
namespace airtruth::video {

struct FreeInput {
  void operator()(AVFormatContext* p) const { avformat_close_input(&p); }
};
struct FreeCodec {
  void operator()(AVCodecContext* p) const { avcodec_free_context(&p); }
};
struct FreeFrame {
  void operator()(AVFrame* p) const { av_frame_free(&p); }
};
struct FreePacket {
  void operator()(AVPacket* p) const { av_packet_free(&p); }
};
using InputPtr = std::unique_ptr<AVFormatContext, FreeInput>;
using CodecPtr = std::unique_ptr<AVCodecContext, FreeCodec>;
using FramePtr = std::unique_ptr<AVFrame, FreeFrame>;
using PacketPtr = std::unique_ptr<AVPacket, FreePacket>;

// libav's own word for an error code.
std::string reason(int error);

// libav would print to standard error; the library never does.
void keep_libav_quiet();

// How a pixel format of libav becomes a Picture; empty for what cannot be held.
struct Layout {
  image::Chroma chroma = image::Chroma::k420;
  bool rgb = false;                 // packed or planar RGB -> planes G, B, R
  bool full_range = false;          // yuvj*, RGB
  bool interleaved_chroma = false;  // nv12, nv16, nv24
  int shift = 0;                    // bits above 8, dropped with rounding
};
std::optional<Layout> layout_of(AVPixelFormat format);

// The nearest format that layout_of knows, for those that stills come in: palettes, 1 bit, 16-bit
// grey and RGB (grey with alpha too). AV_PIX_FMT_NONE for others.
AVPixelFormat plain_kin(AVPixelFormat format);
// A frame in that format (libswscale, no dithering); alpha is dropped.
FramePtr in_format(const AVFrame& frame, AVPixelFormat format);

image::Matrix matrix_of(AVColorSpace space, int height, bool* guessed);
AVColorSpace space_of(image::Matrix matrix);

// Samples of a decoded frame as a Picture of that colour (which fits the layout).
image::Picture picture_of(const AVFrame& frame, const Layout& layout, const image::Colour& colour);

// How a stored picture is to be shown: left and right exchanged first, then turned.
struct Orientation {
  bool mirrored = false;
  int clockwise_deg = 0;  // 0, 90, 180, 270: the nearest
};
// From a display matrix of libav's (nine numbers, 16.16); as it is where the matrix is nonsense.
Orientation orientation_of(const std::int32_t* display_matrix);

// The picture so turned; every sample kept.
image::Picture oriented(image::Picture picture, const Orientation& orientation);

}  // namespace airtruth::video
