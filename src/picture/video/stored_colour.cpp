// SPDX-License-Identifier: Apache-2.0
#include "picture/video/stored_colour.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>
#include <utility>

#include "foundation/base/error.h"
#include "foundation/image/colour.h"

namespace airtruth::video {
namespace {

using image::Chroma;
using image::Colour;
using image::Matrix;
using image::Picture;
using image::Range;

// Converts through packed sRGB where a format cannot store the picture's own colour.
Picture converted(const Picture& picture, const Colour& to) {
  if (picture.colour == to) return picture.clone();
  return image::picture_from_rgb8(image::rgb8_from_picture(picture), to);
}

// Converts from limited to full range (JPEG) and changes nothing else: each plane has its own
// linear map.
Picture with_full_range(const Picture& picture, const Colour& to) {
  Picture result = image::make_picture(picture.width, picture.height, to);
  for (std::size_t i = 0; i < static_cast<std::size_t>(result.plane_count); ++i) {
    for (int y = 0; y < result.planes[i].height; ++y) {
      std::uint8_t* target = result.planes[i].row(y);
      if (i > 0 && picture.plane_count == 1) {
        std::memset(target, 128, static_cast<std::size_t>(result.planes[i].width));
        continue;
      }
      const std::uint8_t* source = picture.planes[i].row(y);
      for (int x = 0; x < result.planes[i].width; ++x) {
        const double value =
            i == 0 ? (source[x] - 16) * 255.0 / 219 : (source[x] - 128) * 255.0 / 224 + 128;
        target[x] = static_cast<std::uint8_t>(std::clamp(std::lround(value), 0L, 255L));
      }
    }
  }
  return result;
}

// Luma, and Cb and Cr as pairs.
void fill_nv12(AVFrame& frame, const Picture& picture) {
  const auto row = [&](int plane, int y) {
    return frame.data[plane] + static_cast<std::ptrdiff_t>(y) * frame.linesize[plane];
  };
  for (int y = 0; y < picture.height; ++y)
    std::memcpy(row(0, y), picture.luma().row(y), static_cast<std::size_t>(picture.width));
  for (int y = 0; y < picture.planes[1].height; ++y)
    for (int x = 0; x < picture.planes[1].width; ++x) {
      row(1, y)[2 * x] = picture.planes[1].row(y)[x];
      row(1, y)[2 * x + 1] = picture.planes[2].row(y)[x];
    }
}

void fill_frame(AVFrame& frame, const Picture& picture) {
  if (frame.format == AV_PIX_FMT_NV12) return fill_nv12(frame, picture);
  if (picture.colour.matrix == Matrix::kRgb) {
    for (int y = 0; y < picture.height; ++y) {
      std::uint8_t* row = frame.data[0] + static_cast<std::ptrdiff_t>(y) * frame.linesize[0];
      for (int x = 0; x < picture.width; ++x) {
        row[4 * x] = picture.planes[1].row(y)[x];
        row[4 * x + 1] = picture.planes[0].row(y)[x];
        row[4 * x + 2] = picture.planes[2].row(y)[x];
        row[4 * x + 3] = 255;
      }
    }
    return;
  }
  for (int i = 0; i < picture.plane_count; ++i) {
    const image::Plane& plane = picture.planes[static_cast<std::size_t>(i)];
    for (int y = 0; y < plane.height; ++y)
      std::memcpy(frame.data[i] + static_cast<std::ptrdiff_t>(y) * frame.linesize[i],
                  plane.row(y),
                  static_cast<std::size_t>(plane.width));
  }
}

}  // namespace

Colour stored_colour(const Colour& colour, Format format, const std::filesystem::path& path) {
  Colour stored = colour;
  if (format == Format::kMkv || format == Format::kPng) return stored;
  if (colour.matrix == Matrix::kRgb)
    stored = {Chroma::k444, Matrix::kBt709, Range::kFull, image::Siting::kCenter};
  if (format == Format::kAvi) {
    // JPEG supports no other range.
    stored.range = Range::kFull;
    if (stored.chroma == Chroma::kNone) stored.chroma = Chroma::k420;
  }
  if (stored.chroma == Chroma::k440)
    throw Error("mp4 and avi cannot hold 4:4:0; expected output.video = \"mkv\" or \"png\"",
                {path.string()});
  return stored;
}

// H.264 halves chroma in whole samples. libx264 also refuses such a size, but leaks memory when it
// does.
void check_size(const StreamInfo& info,
                Chroma chroma,
                Format format,
                const std::filesystem::path& path) {
  const bool half_width = chroma == Chroma::k420 || chroma == Chroma::k422;
  const bool half_height = chroma == Chroma::k420;
  if (format != Format::kMp4 ||
      ((!half_width || info.width % 2 == 0) && (!half_height || info.height % 2 == 0)))
    return;
  throw Error("H.264 cannot hold " + std::to_string(info.width) + "x" +
                  std::to_string(info.height) +
                  " with halved chroma (an odd size); expected output.video = \"mkv\", \"avi\" or "
                  "\"png\"",
              {path.string()});
}

AVPixelFormat pixel_format(const Colour& colour, Format format) {
  const bool jpeg = format == Format::kAvi;
  if (colour.matrix == Matrix::kRgb) return AV_PIX_FMT_BGR0;
  switch (colour.chroma) {
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

void fill_frame_as(AVFrame& frame, const Picture& picture, const Colour& stored, Format format) {
  if (picture.colour == stored) {
    fill_frame(frame, picture);
  } else if (picture.colour.matrix != Matrix::kRgb && format == Format::kAvi &&
             picture.colour.range == Range::kLimited) {
    fill_frame(frame, with_full_range(picture, stored));
  } else if (picture.colour.matrix == Matrix::kRgb) {
    fill_frame(frame, converted(picture, stored));
  } else {
    Picture same = picture.clone();
    same.colour = stored;
    fill_frame(
        frame,
        stored.chroma == picture.colour.chroma ? std::move(same) : converted(picture, stored));
  }
}

}  // namespace airtruth::video
