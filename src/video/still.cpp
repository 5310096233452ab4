// SPDX-License-Identifier: Apache-2.0
#include "video/still.h"

#include <algorithm>
#include <cstring>
#include <string>

#include "base/error.h"
#include "base/files.h"
#include "image/colour.h"
#include "video/libav.h"
#include "video/reader.h"

namespace airtruth::video {
namespace {

std::string lower_extension(const fs::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(), [](unsigned char c) {
    return static_cast<char>(std::tolower(c));
  });
  return extension;
}

FramePtr frame_of(const image::Rgb8& rgb, AVPixelFormat format) {
  FramePtr frame(av_frame_alloc());
  frame->format = format;
  frame->width = rgb.width;
  frame->height = rgb.height;
  if (av_frame_get_buffer(frame.get(), 0) < 0) throw std::bad_alloc();
  if (format == AV_PIX_FMT_RGB24) {
    for (int y = 0; y < rgb.height; ++y)
      std::memcpy(frame->data[0] + static_cast<std::ptrdiff_t>(y) * frame->linesize[0],
                  rgb.at(0, y),
                  static_cast<std::size_t>(rgb.width) * 3);
    return frame;
  }
  const image::Picture picture = image::picture_from_rgb8(
      rgb,
      {image::Chroma::k444, image::Matrix::kBt601, image::Range::kFull, image::Siting::kCenter});
  for (std::size_t i = 0; i < 3; ++i) {
    for (int y = 0; y < rgb.height; ++y)
      std::memcpy(frame->data[i] + static_cast<std::ptrdiff_t>(y) * frame->linesize[i],
                  picture.planes[i].row(y),
                  static_cast<std::size_t>(rgb.width));
  }
  frame->color_range = AVCOL_RANGE_JPEG;
  return frame;
}

std::string encoded(const image::Rgb8& rgb, bool jpeg, int quality, const fs::path& path) {
  keep_libav_quiet();
  const AVCodec* encoder = avcodec_find_encoder(jpeg ? AV_CODEC_ID_MJPEG : AV_CODEC_ID_PNG);
  const CodecPtr codec(avcodec_alloc_context3(encoder));
  codec->width = rgb.width;
  codec->height = rgb.height;
  codec->pix_fmt = jpeg ? AV_PIX_FMT_YUVJ444P : AV_PIX_FMT_RGB24;
  codec->time_base = {1, 1};
  codec->flags |= AV_CODEC_FLAG_BITEXACT;
  codec->color_range = AVCOL_RANGE_JPEG;
  if (jpeg) {
    codec->flags |= AV_CODEC_FLAG_QSCALE;
    codec->global_quality = FF_QP2LAMBDA * quality;
  }
  const FramePtr frame = frame_of(rgb, codec->pix_fmt);
  frame->quality = codec->global_quality;
  frame->pts = 0;
  const PacketPtr packet(av_packet_alloc());
  int result = avcodec_open2(codec.get(), encoder, nullptr);
  if (result >= 0) result = avcodec_send_frame(codec.get(), frame.get());
  if (result >= 0) result = avcodec_receive_packet(codec.get(), packet.get());
  if (result < 0) throw Error("cannot encode the picture: " + reason(result), {path.string()});
  return {reinterpret_cast<const char*>(packet->data), static_cast<std::size_t>(packet->size)};
}

}  // namespace

image::Rgb8 read_still(const fs::path& path) {
  ReaderOptions options;
  options.frame_count = 1;
  options.threads = 1;
  auto frame = Reader(path, options).next();
  if (!frame) throw Error("holds no picture", {path.string()});
  return image::rgb8_from_picture(frame->picture);
}

std::string jpeg_of(const image::Rgb8& rgb, int quality) { return encoded(rgb, true, quality, {}); }

void write_still(const fs::path& path, const image::Rgb8& rgb, Flush flush) {
  const std::string extension = lower_extension(path);
  const bool jpeg = extension == ".jpg" || extension == ".jpeg";
  if (!jpeg && extension != ".png")
    throw Error("has an unknown ending; expected .png or .jpg", {path.string()});
  write_file(path, encoded(rgb, jpeg, 3, path), flush);
}

image::Mask read_mask(const fs::path& path, int width, int height) {
  const image::Rgb8 picture = read_still(path);
  if (picture.width != width || picture.height != height)
    throw Error("is " + std::to_string(picture.width) + "x" + std::to_string(picture.height) +
                    "; expected the video's " + std::to_string(width) + "x" +
                    std::to_string(height),
                {path.string()});
  image::Mask mask;
  mask.width = width;
  mask.height = height;
  mask.free.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  bool any = false;
  for (std::size_t i = 0; i < mask.free.size(); ++i) {
    const std::uint8_t* p = picture.samples.get() + 3 * i;
    mask.free[i] = (int(p[0]) + 2 * int(p[1]) + int(p[2])) / 4 >= 128 ? 255 : 0;
    any = any || mask.free[i] != 0;
  }
  if (!any)
    throw Error(
        "is black all over: the own aircraft would hide everything; expected white where the sky "
        "is free",
        {path.string()});
  return mask;
}

}  // namespace airtruth::video
