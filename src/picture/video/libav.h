// SPDX-License-Identifier: Apache-2.0
#pragma once

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/display.h>
#include <libavutil/hwcontext.h>
#include <libavutil/imgutils.h>
#include <libavutil/opt.h>
#include <libavutil/pixdesc.h>
#include <libavutil/video_enc_params.h>
#include <libswscale/swscale.h>
}

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "foundation/image/picture.h"
#include "picture/video/reader.h"

// Ownership of libav's C objects, and the mapping of its pixel formats to this project's. Only this
// module includes it.
namespace airtruth::video {

// Frees an object by a function of libav that takes the address of its pointer.
template <auto kFree>
struct Free {
  template <typename Object>
  void operator()(Object* p) const {
    kFree(&p);
  }
};
struct FreeScaler {
  void operator()(SwsContext* p) const { sws_freeContext(p); }
};
// Options for a call of libav.
struct Settings {
  AVDictionary* entries = nullptr;
  ~Settings() { av_dict_free(&entries); }
};
using InputPtr = std::unique_ptr<AVFormatContext, Free<avformat_close_input>>;
using CodecPtr = std::unique_ptr<AVCodecContext, Free<avcodec_free_context>>;
using FramePtr = std::unique_ptr<AVFrame, Free<av_frame_free>>;
using PacketPtr = std::unique_ptr<AVPacket, Free<av_packet_free>>;
using ScalerPtr = std::unique_ptr<SwsContext, FreeScaler>;

// libav's own description of an error code.
std::string reason(int error);

// Turns off libav's output to standard error: the library never prints. libav has one receiver of
// messages in a process, which is then this module's.
void keep_libav_quiet();

// Counts what libav says of an unopened decoder from now on, its information included. A decoder of
// several threads tells of concealed errors in no other way that can be relied on: it copies the
// flags of a frame while another thread may yet set them.
void count_messages(AVCodecContext& codec, std::atomic<int>& count);

// FFmpeg 5.1 (Debian 12) and 7.1 (Debian 13) name these two differently.

inline bool is_key_frame(const AVFrame& frame) {
#if LIBAVUTIL_VERSION_MAJOR >= 59
  return (frame.flags & AV_FRAME_FLAG_KEY) != 0;
#else
  return frame.key_frame == 1;
#endif
}

// Nine numbers, or nullptr where the stream has no display matrix.
inline const std::int32_t* display_matrix_of(const AVStream& stream) {
#if LIBAVFORMAT_VERSION_MAJOR >= 61
  const AVCodecParameters& codec = *stream.codecpar;
  const AVPacketSideData* data = av_packet_side_data_get(
      codec.coded_side_data, codec.nb_coded_side_data, AV_PKT_DATA_DISPLAYMATRIX);
  const std::uint8_t* bytes = data == nullptr ? nullptr : data->data;
#else
  const std::uint8_t* bytes = av_stream_get_side_data(&stream, AV_PKT_DATA_DISPLAYMATRIX, nullptr);
#endif
  return reinterpret_cast<const std::int32_t*>(bytes);
}

// How a pixel format of libav becomes a Picture.
struct Layout {
  image::Chroma chroma = image::Chroma::k420;
  // Packed or planar RGB, stored as planes G, B, R.
  bool rgb = false;
  // True for yuvj* and RGB.
  bool full_range = false;
  // Number of bits above 8; they are dropped with rounding.
  int shift = 0;
};
// Empty for a format that a Picture cannot hold.
std::optional<Layout> layout_of(AVPixelFormat format);

// The nearest format that layout_of() supports, for formats that stills use: palettes, 1 bit,
// 16-bit grey and RGB (grey with alpha too). AV_PIX_FMT_NONE for all others.
AVPixelFormat plain_kin(AVPixelFormat format);
// Converts a frame to its plain kin, or packs its planes for an encoder (libswscale, no dithering).
// Alpha is dropped.
FramePtr in_format(const AVFrame& frame, AVPixelFormat format);

// By the picture's height where `space` is untagged; empty for one that a Picture cannot hold.
// SMPTE 240M, whose coefficients are within 0.015 of BT.709's, is read as it.
std::optional<image::Matrix> matrix_of(AVColorSpace space, int height);
AVColorSpace space_of(image::Matrix matrix);

// The samples of a decoded frame as a Picture of that colour, which must fit the layout.
image::Picture picture_of(const AVFrame& frame, const Layout& layout, const image::Colour& colour);

// The format of grey or Y'CbCr with a plane for each component. `jpeg`: the one of JPEG's full
// range (yuvj*) where there is one.
AVPixelFormat planar_format(image::Chroma chroma, bool jpeg = false);

// A frame with memory for its samples. Throws std::bad_alloc.
FramePtr new_frame(AVPixelFormat format, int width, int height);

// Copies the planes of a Picture to those of a frame of the same layout.
void copy_planes(const image::Picture& picture, AVFrame& frame);

// How a stored picture is shown: left and right are exchanged first, then the picture is rotated.
struct Orientation {
  bool mirrored = false;
  // The nearest of 0, 90, 180 and 270.
  int clockwise_deg = 0;
};
// The orientation of a libav display matrix (nine numbers, 16.16 fixed point). None, or an invalid
// one, gives the identity.
Orientation orientation_of(const std::int32_t* display_matrix);

// The picture with the orientation applied. Every sample keeps its value.
image::Picture oriented(image::Picture picture, const Orientation& orientation);

}  // namespace airtruth::video
