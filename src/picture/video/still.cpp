// SPDX-License-Identifier: Apache-2.0
#include "picture/video/still.h"

#include <algorithm>
#include <new>

#include "foundation/base/error.h"
#include "foundation/base/file_state.h"
#include "foundation/base/names.h"
#include "foundation/image/colour.h"
#include "picture/video/libav.h"
#include "picture/video/media_file.h"
#include "picture/video/reader.h"

namespace airtruth::video {
namespace {

// A frame with one plane of packed samples, `row_bytes` to a row.
FramePtr packed_frame(
    AVPixelFormat format, int width, int height, const std::uint8_t* samples, int row_bytes) {
  FramePtr frame = new_frame(format, width, height);
  av_image_copy_plane(frame->data[0], frame->linesize[0], samples, row_bytes, row_bytes, height);
  return frame;
}

FramePtr frame_of(const image::Rgb8& rgb, AVPixelFormat format) {
  if (format == AV_PIX_FMT_RGB24)
    return packed_frame(format, rgb.width, rgb.height, rgb.at(0, 0), 3 * rgb.width);
  FramePtr frame = new_frame(format, rgb.width, rgb.height);
  copy_planes(image::picture_from_rgb8(rgb,
                                       {image::Chroma::k444,
                                        image::Matrix::kBt601,
                                        image::Range::kFull,
                                        image::Siting::kCenter}),
              *frame);
  frame->color_range = AVCOL_RANGE_JPEG;
  return frame;
}

int sws_matrix(image::Matrix matrix) {
  if (matrix == image::Matrix::kBt709) return SWS_CS_ITU709;
  return matrix == image::Matrix::kBt2020 ? SWS_CS_BT2020 : SWS_CS_ITU601;
}

// The JPEG form: BT.601, full range. Halved chroma stays halved, without a conversion to RGB.
FramePtr jpeg_frame(const image::Picture& picture) {
  keep_libav_quiet();
  const AVPixelFormat from = picture.colour.matrix == image::Matrix::kRgb
                                 ? AV_PIX_FMT_GBRP
                                 : planar_format(picture.colour.chroma);
  const AVPixelFormat to = from == AV_PIX_FMT_YUV420P ? AV_PIX_FMT_YUVJ420P : AV_PIX_FMT_YUVJ444P;
  const int w = picture.width;
  const int h = picture.height;
  const ScalerPtr scaler(sws_getContext(
      w, h, from, w, h, to, SWS_BILINEAR | SWS_ACCURATE_RND, nullptr, nullptr, nullptr));
  if (!scaler) throw std::bad_alloc();
  const bool is_full = picture.colour.range == image::Range::kFull || from == AV_PIX_FMT_GBRP;
  sws_setColorspaceDetails(scaler.get(),
                           sws_getCoefficients(sws_matrix(picture.colour.matrix)),
                           is_full ? 1 : 0,
                           sws_getCoefficients(SWS_CS_ITU601),
                           1,
                           0,
                           1 << 16,
                           1 << 16);
  FramePtr frame = new_frame(to, w, h);
  const std::uint8_t* data[4] = {};
  int strides[4] = {};
  for (int i = 0; i < picture.plane_count; ++i) {
    data[i] = picture.planes[static_cast<std::size_t>(i)].row(0);
    strides[i] = picture.planes[static_cast<std::size_t>(i)].stride;
  }
  sws_scale(scaler.get(), data, strides, 0, h, frame->data, frame->linesize);
  frame->color_range = AVCOL_RANGE_JPEG;
  return frame;
}

std::string encoded(const FramePtr& frame, int quality, const fs::path& path) {
  keep_libav_quiet();
  const auto format = static_cast<AVPixelFormat>(frame->format);
  const bool jpeg = format != AV_PIX_FMT_RGB24 && format != AV_PIX_FMT_GRAY8;
  const AVCodec* encoder = avcodec_find_encoder(jpeg ? AV_CODEC_ID_MJPEG : AV_CODEC_ID_PNG);
  const CodecPtr codec(avcodec_alloc_context3(encoder));
  codec->width = frame->width;
  codec->height = frame->height;
  codec->pix_fmt = format;
  codec->time_base = {1, 1};
  codec->flags |= AV_CODEC_FLAG_BITEXACT;
  codec->color_range = AVCOL_RANGE_JPEG;
  codec->thread_count = 1;
  if (jpeg) {
    codec->flags |= AV_CODEC_FLAG_QSCALE;
    codec->global_quality = FF_QP2LAMBDA * quality;
  }
  frame->quality = codec->global_quality;
  frame->pts = 0;
  const PacketPtr packet(av_packet_alloc());
  int result = avcodec_open2(codec.get(), encoder, nullptr);
  if (result >= 0) result = avcodec_send_frame(codec.get(), frame.get());
  if (result >= 0) result = avcodec_receive_packet(codec.get(), packet.get());
  if (result < 0) throw Error("cannot encode the picture: " + reason(result), {path.string()});
  return {reinterpret_cast<const char*>(packet->data), static_cast<std::size_t>(packet->size)};
}

constexpr int kQuality = 3;

bool is_jpeg(const fs::path& path) {
  const std::string extension = lower_case(path.extension().string());
  const bool jpeg = extension == ".jpg" || extension == ".jpeg";
  if (!jpeg && extension != ".png")
    throw Error("has an unknown ending; expected .png or .jpg", {path.string()});
  return jpeg;
}

// A pixel of a mask's picture is free from this luma on.
constexpr int kLight = 128;

image::Picture first_picture(const fs::path& path) {
  std::error_code unknown;
  if (!fs::exists(path, unknown))
    throw Error("does not exist; expected a picture", {path.string()});
  ReaderOptions options;
  options.frame_count = 1;
  options.threads = 1;
  options.with_timing = false;
  auto frame = Reader(path, options).next();
  if (!frame) throw Error("holds no picture", {path.string()});
  return std::move(frame->picture);
}

}  // namespace

void check_still_output(const fs::path& path, bool overwrite) {
  if (path.empty()) return;
  is_jpeg(path);
  check_output_file(path, overwrite);
}

std::pair<int, int> size_of_still(const fs::path& path) {
  const InputPtr input = open_media(path, Media::kNumberedImage);
  // libav's decoders of pictures fill in the size from the header here, without the samples.
  if (find_streams(*input) >= 0 && input->nb_streams == 1) {
    const AVCodecParameters& known = *input->streams[0]->codecpar;
    if (known.width > 0 && known.height > 0) return {known.width, known.height};
  }
  const image::Rgb8 picture = read_still(path);
  return {picture.width, picture.height};
}

image::Rgb8 read_still(const fs::path& path) {
  return image::rgb8_from_picture(first_picture(path));
}

std::string jpeg_of(const image::Rgb8& rgb, int quality) {
  return encoded(frame_of(rgb, AV_PIX_FMT_YUVJ444P), quality, {});
}

std::string png_of(const Grey& grey) {
  check(grey.samples.size() == pixels_in(grey.width, grey.height),
        "a grey picture has a sample for each pixel");
  return encoded(
      packed_frame(AV_PIX_FMT_GRAY8, grey.width, grey.height, grey.samples.data(), grey.width),
      0,
      {});
}

Grey read_grey(const fs::path& path) {
  const image::Picture picture = first_picture(path);
  if (picture.plane_count != 1)
    throw Error("is no grey picture; expected one channel of 8 bits", {path.string()});
  Grey grey{picture.width, picture.height, {}};
  for (int y = 0; y < grey.height; ++y)
    grey.samples.insert(
        grey.samples.end(), picture.planes[0].row(y), picture.planes[0].row(y) + grey.width);
  return grey;
}

void write_still(const fs::path& path, const image::Rgb8& rgb, Flush flush) {
  const AVPixelFormat format = is_jpeg(path) ? AV_PIX_FMT_YUVJ444P : AV_PIX_FMT_RGB24;
  write_file(path, encoded(frame_of(rgb, format), kQuality, path), flush);
}

void write_still(const fs::path& path, const image::Picture& picture, Flush flush) {
  if (!is_jpeg(path)) return write_still(path, image::rgb8_from_picture(picture), flush);
  write_file(path, encoded(jpeg_frame(picture), kQuality, path), flush);
}

image::Mask read_mask(const fs::path& path, int width, int height) {
  const image::Rgb8 rgb = read_still(path);
  if (rgb.width != width || rgb.height != height)
    throw Error("is " + std::to_string(rgb.width) + "x" + std::to_string(rgb.height) +
                    "; expected the video's " + std::to_string(width) + "x" +
                    std::to_string(height),
                {path.string()});
  image::Mask mask;
  mask.width = width;
  mask.height = height;
  mask.free.resize(pixels_in(width, height));
  for (std::size_t i = 0; i < mask.free.size(); ++i) {
    const std::uint8_t* code = &rgb.samples[3 * i];
    mask.free[i] = (code[0] + 2 * code[1] + code[2]) / 4 >= kLight ? 255 : 0;
  }
  const bool any = std::any_of(mask.free.begin(), mask.free.end(), [](auto v) { return v != 0; });
  if (!any)
    throw Error(
        "is black all over: the own aircraft would hide everything; expected white where the sky "
        "is free",
        {path.string()});
  return mask;
}

}  // namespace airtruth::video
