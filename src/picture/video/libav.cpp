// SPDX-License-Identifier: Apache-2.0
#include "picture/video/libav.h"

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstring>
#include <new>
#include <utility>

#include <Eigen/Core>

#include "foundation/base/error.h"
#include "foundation/geometry/transform.h"
#include "foundation/image/colour.h"

namespace airtruth::video {
namespace {

using image::Chroma;
using image::Picture;
using image::Plane;

std::optional<Chroma> chroma_of(const AVPixFmtDescriptor& format) {
  if (format.nb_components < 3) return Chroma::kNone;
  const int w = format.log2_chroma_w;
  const int h = format.log2_chroma_h;
  if (w == 1 && h == 1) return Chroma::k420;
  if (w == 1 && h == 0) return Chroma::k422;
  if (w == 0 && h == 1) return Chroma::k440;
  if (w == 0 && h == 0) return Chroma::k444;
  return std::nullopt;
}

// Copies one component (0..2) at its own resolution into a plane, by libav's description of the
// format.
void copy_component(const AVFrame& frame,
                    const AVPixFmtDescriptor& format,
                    int component,
                    int shift,
                    Plane& plane) {
  const AVComponentDescriptor& c = format.comp[component];
  const bool wide = c.depth > 8;
  const int half = shift > 0 ? 1 << (shift - 1) : 0;
  for (int y = 0; y < plane.height; ++y) {
    const std::uint8_t* source =
        frame.data[c.plane] + static_cast<std::ptrdiff_t>(y) * frame.linesize[c.plane] + c.offset;
    std::uint8_t* target = plane.row(y);
    if (!wide && c.step == 1) {
      std::memcpy(target, source, static_cast<std::size_t>(plane.width));
    } else if (!wide) {
      image::take_every(source, c.step, plane.width, target);
    } else {
      for (int x = 0; x < plane.width; ++x) {
        std::uint16_t value = 0;
        std::memcpy(&value, source + x * c.step, 2);
        target[x] = static_cast<std::uint8_t>(std::min(255, ((value >> c.shift) + half) >> shift));
      }
    }
  }
}

using Samples =
    Eigen::Map<Eigen::Array<std::uint8_t, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>,
               Eigen::Unaligned,
               Eigen::OuterStride<>>;

Samples samples_of(Plane& plane) {
  return {plane.row(0), plane.height, plane.width, Eigen::OuterStride<>(plane.stride)};
}

// libav's own choice. It marks the decoders whose messages are counted: others in the process may
// have objects of their own in `opaque`.
AVPixelFormat chosen_format(AVCodecContext* codec, const AVPixelFormat* formats) {
  return avcodec_default_get_format(codec, formats);
}

// libav calls it from any thread of a decoder.
void count_message(void* object, int level, const char*, va_list) {
  constexpr int kLevelBits = 0xff;  // the bits above are a colour
  if (object == nullptr || (level & kLevelBits) > AV_LOG_INFO) return;
  if (*static_cast<const AVClass**>(object) != avcodec_get_class()) return;
  const auto& codec = *static_cast<const AVCodecContext*>(object);
  if (codec.get_format == chosen_format) ++*static_cast<std::atomic<int>*>(codec.opaque);
}

}  // namespace

std::string reason(int error) {
  char text[AV_ERROR_MAX_STRING_SIZE] = {};
  av_strerror(error, text, sizeof text);
  return text;
}

void keep_libav_quiet() {
  av_log_set_level(AV_LOG_QUIET);
  av_log_set_callback(count_message);
}

void count_messages(AVCodecContext& codec, std::atomic<int>& count) {
  codec.get_format = chosen_format;
  codec.opaque = &count;
}

std::optional<Layout> layout_of(AVPixelFormat format) {
  const AVPixFmtDescriptor* d = av_pix_fmt_desc_get(format);
  if (d == nullptr) return std::nullopt;
  constexpr auto kOdd = AV_PIX_FMT_FLAG_HWACCEL | AV_PIX_FMT_FLAG_BITSTREAM | AV_PIX_FMT_FLAG_PAL |
                        AV_PIX_FMT_FLAG_BAYER | AV_PIX_FMT_FLAG_FLOAT | AV_PIX_FMT_FLAG_BE;
  if ((d->flags & kOdd) != 0 || d->comp[0].depth < 8) return std::nullopt;
  const auto chroma = chroma_of(*d);
  if (!chroma) return std::nullopt;
  Layout layout;
  layout.chroma = *chroma;
  layout.rgb = (d->flags & AV_PIX_FMT_FLAG_RGB) != 0;
  layout.shift = d->comp[0].depth - 8;
  const std::string name = d->name;
  layout.full_range = layout.rgb || name.rfind("yuvj", 0) == 0;
  return layout;
}

AVPixelFormat plain_kin(AVPixelFormat format) {
  const AVPixFmtDescriptor* d = av_pix_fmt_desc_get(format);
  if (d == nullptr || layout_of(format)) return AV_PIX_FMT_NONE;
  if ((d->flags & (AV_PIX_FMT_FLAG_HWACCEL | AV_PIX_FMT_FLAG_BAYER | AV_PIX_FMT_FLAG_FLOAT)) != 0 ||
      sws_isSupportedInput(format) == 0)
    return AV_PIX_FMT_NONE;
  const bool one_bit = format == AV_PIX_FMT_MONOBLACK || format == AV_PIX_FMT_MONOWHITE;
  if (format == AV_PIX_FMT_PAL8 || (d->flags & AV_PIX_FMT_FLAG_RGB) != 0) return AV_PIX_FMT_RGB24;
  return one_bit || d->nb_components <= 2 ? AV_PIX_FMT_GRAY8 : AV_PIX_FMT_NONE;
}

FramePtr in_format(const AVFrame& frame, AVPixelFormat format) {
  const ScalerPtr scaler(sws_alloc_context());
  FramePtr result = new_frame(format, frame.width, frame.height);
  check(scaler != nullptr, "memory is at hand");
  av_opt_set_int(scaler.get(), "srcw", frame.width, 0);
  av_opt_set_int(scaler.get(), "srch", frame.height, 0);
  av_opt_set_int(scaler.get(), "src_format", frame.format, 0);
  av_opt_set_int(scaler.get(), "dstw", frame.width, 0);
  av_opt_set_int(scaler.get(), "dsth", frame.height, 0);
  av_opt_set_int(scaler.get(), "dst_format", format, 0);
  av_opt_set_int(scaler.get(), "src_range", 1, 0);
  av_opt_set_int(scaler.get(), "dst_range", 1, 0);
  av_opt_set_int(scaler.get(), "sws_flags", SWS_POINT | SWS_ACCURATE_RND | SWS_FULL_CHR_H_INT, 0);
  av_opt_set(scaler.get(), "sws_dither", "none", 0);
  check(sws_init_context(scaler.get(), nullptr, nullptr) >= 0,
        "libswscale knows what it said it knows");
  av_frame_copy_props(result.get(), &frame);
  sws_scale(
      scaler.get(), frame.data, frame.linesize, 0, frame.height, result->data, result->linesize);
  return result;
}

std::optional<image::Matrix> matrix_of(AVColorSpace space, int height) {
  switch (space) {
    case AVCOL_SPC_RGB:
      return image::Matrix::kRgb;
    case AVCOL_SPC_BT709:
    case AVCOL_SPC_SMPTE240M:
      return image::Matrix::kBt709;
    case AVCOL_SPC_BT470BG:
    case AVCOL_SPC_SMPTE170M:
    case AVCOL_SPC_FCC:
      return image::Matrix::kBt601;
    case AVCOL_SPC_BT2020_NCL:
    case AVCOL_SPC_BT2020_CL:
      return image::Matrix::kBt2020;
    case AVCOL_SPC_UNSPECIFIED:
    case AVCOL_SPC_RESERVED:
      return height < 720 ? image::Matrix::kBt601 : image::Matrix::kBt709;
    default:
      return std::nullopt;
  }
}

AVColorSpace space_of(image::Matrix matrix) {
  return matrix == image::Matrix::kRgb     ? AVCOL_SPC_RGB
         : matrix == image::Matrix::kBt601 ? AVCOL_SPC_SMPTE170M
         : matrix == image::Matrix::kBt709 ? AVCOL_SPC_BT709
                                           : AVCOL_SPC_BT2020_NCL;
}

Picture picture_of(const AVFrame& frame, const Layout& layout, const image::Colour& colour) {
  const AVPixFmtDescriptor* format = av_pix_fmt_desc_get(static_cast<AVPixelFormat>(frame.format));
  Picture picture = image::make_picture(frame.width, frame.height, colour);
  // libav's order is R, G, B; a Picture's is G, B, R.
  constexpr int kFromRgb[] = {1, 2, 0};
  for (int i = 0; i < picture.plane_count; ++i)
    copy_component(frame,
                   *format,
                   layout.rgb ? kFromRgb[i] : i,
                   layout.shift,
                   picture.planes[static_cast<std::size_t>(i)]);
  return picture;
}

AVPixelFormat planar_format(Chroma chroma, bool jpeg) {
  switch (chroma) {
    case Chroma::kNone:
      return AV_PIX_FMT_GRAY8;
    case Chroma::k420:
      return jpeg ? AV_PIX_FMT_YUVJ420P : AV_PIX_FMT_YUV420P;
    case Chroma::k422:
      return jpeg ? AV_PIX_FMT_YUVJ422P : AV_PIX_FMT_YUV422P;
    case Chroma::k440:
      return jpeg ? AV_PIX_FMT_YUVJ440P : AV_PIX_FMT_YUV440P;
    case Chroma::k444:
      return jpeg ? AV_PIX_FMT_YUVJ444P : AV_PIX_FMT_YUV444P;
  }
  return AV_PIX_FMT_NONE;
}

FramePtr new_frame(AVPixelFormat format, int width, int height) {
  FramePtr frame(av_frame_alloc());
  if (!frame) throw std::bad_alloc();
  frame->format = format;
  frame->width = width;
  frame->height = height;
  if (av_frame_get_buffer(frame.get(), 0) < 0) throw std::bad_alloc();
  return frame;
}

void copy_planes(const Picture& picture, AVFrame& frame) {
  for (int i = 0; i < picture.plane_count; ++i) {
    const Plane& plane = picture.planes[static_cast<std::size_t>(i)];
    av_image_copy_plane(
        frame.data[i], frame.linesize[i], plane.row(0), plane.stride, plane.width, plane.height);
  }
}

Orientation orientation_of(const std::int32_t* m) {
  Orientation result;
  if (m == nullptr) return result;
  // x' = a x + c y, y' = b x + d y, with y down.
  double a = m[0];
  double b = m[1];
  const double c = m[3];
  const double d = m[4];
  const double area = a * d - b * c;
  if (area == 0) return result;
  result.mirrored = area < 0;
  if (result.mirrored) a = -a, b = -b;
  const int quarter = static_cast<int>(std::lround(std::atan2(b, a) / (kPi / 2)));
  result.clockwise_deg = ((quarter % 4) + 4) % 4 * 90;
  return result;
}

Picture oriented(Picture picture, const Orientation& orientation) {
  const int turn_deg = orientation.clockwise_deg;
  if (orientation.mirrored)
    for (std::size_t i = 0; i < static_cast<std::size_t>(picture.plane_count); ++i)
      samples_of(picture.planes[i]).rowwise().reverseInPlace();
  if (turn_deg == 0) return picture;
  image::Colour colour = picture.colour;
  if (turn_deg % 180 != 0) {
    std::swap(picture.width, picture.height);
    if (picture.colour.chroma == Chroma::k422) colour.chroma = Chroma::k440;
    if (picture.colour.chroma == Chroma::k440) colour.chroma = Chroma::k422;
  }
  Picture turned = image::make_picture(picture.width, picture.height, colour);
  for (std::size_t i = 0; i < static_cast<std::size_t>(picture.plane_count); ++i) {
    const Samples from = samples_of(picture.planes[i]);
    Samples to = samples_of(turned.planes[i]);
    if (turn_deg == 90) to = from.colwise().reverse().transpose();
    if (turn_deg == 180) to = from.reverse();
    if (turn_deg == 270) to = from.rowwise().reverse().transpose();
  }
  return turned;
}

}  // namespace airtruth::video
