// SPDX-License-Identifier: Apache-2.0
#include "picture/video/encoder_frame.h"

#include <new>
#include <utility>

#include "foundation/base/error.h"
#include "picture/video/stored_colour.h"

extern "C" {
#include <libavutil/hwcontext.h>
}

namespace airtruth::video {
namespace {

FramePtr blank_frame(const AVCodecContext& encoder) {
  FramePtr frame(av_frame_alloc());
  if (!frame) throw std::bad_alloc();
  frame->format = encoder.pix_fmt;
  frame->width = encoder.width;
  frame->height = encoder.height;
  frame->color_range = encoder.color_range;
  frame->colorspace = encoder.colorspace;
  return frame;
}

// The frame in the memory of the encoder's device.
FramePtr on_device(const AVCodecContext& encoder, const AVFrame& frame) {
  FramePtr result = blank_frame(encoder);
  int done = av_hwframe_get_buffer(encoder.hw_frames_ctx, result.get(), 0);
  if (done >= 0) done = av_hwframe_transfer_data(result.get(), &frame, 0);
  if (done < 0) throw Error("the encoder's device takes no frame: " + reason(done));
  return result;
}

}  // namespace

FramePtr copied_frame(const AVCodecContext& encoder,
                      const image::Picture& picture,
                      const image::Colour& stored,
                      Format format) {
  FramePtr frame = blank_frame(encoder);
  const bool is_on_device = encoder.hw_frames_ctx != nullptr;
  if (is_on_device) frame->format = AV_PIX_FMT_NV12;
  if (av_frame_get_buffer(frame.get(), 0) < 0) throw std::bad_alloc();
  fill_frame_as(*frame, picture, stored, format);
  return is_on_device ? on_device(encoder, *frame) : std::move(frame);
}

FramePtr lent_frame(const AVCodecContext& encoder, std::shared_ptr<const Frame> frame) {
  using Owner = std::shared_ptr<const Frame>;
  FramePtr lent = blank_frame(encoder);
  const image::Picture& picture = frame->picture;
  for (int i = 0; i < picture.plane_count; ++i) {
    const image::Plane& plane = picture.planes[static_cast<std::size_t>(i)];
    // An encoder only reads; the buffer is marked read-only.
    lent->data[i] = const_cast<std::uint8_t*>(plane.row(0));
    lent->linesize[i] = plane.stride;
  }
  auto owner = std::make_unique<Owner>(std::move(frame));
  const auto release = [](void* opaque, std::uint8_t*) { delete static_cast<Owner*>(opaque); };
  lent->buf[0] = av_buffer_create(
      lent->data[0],
      static_cast<std::size_t>(lent->linesize[0]) * static_cast<std::size_t>(lent->height),
      release,
      owner.get(),
      AV_BUFFER_FLAG_READONLY);
  if (lent->buf[0] == nullptr) throw std::bad_alloc();
  owner.release();  // libav's buffer owns it from here on
  return lent;
}

}  // namespace airtruth::video
