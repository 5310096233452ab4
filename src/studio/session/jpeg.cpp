// SPDX-License-Identifier: Apache-2.0
#include "studio/session/jpeg.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <new>

#include <opencv2/imgproc.hpp>
#include <turbojpeg.h>

#include "foundation/base/error.h"
#include "foundation/image/colour.h"
#include "show/drawing/draw.h"

namespace airtruth::session {
namespace {

// Seams of crops cannot be seen from here on: chosen by looking.
constexpr int kQuality = 92;

struct Destroy {
  void operator()(void* handle) const { tjDestroy(handle); }
};

}  // namespace

std::string jpeg_of(const image::Rgb8& rgb) {
  const std::unique_ptr<void, Destroy> encoder(tjInitCompress());
  if (!encoder) throw std::bad_alloc();
  unsigned char* bytes = nullptr;
  unsigned long size = 0;
  const int failed = tjCompress2(encoder.get(),
                                 rgb.samples.get(),
                                 rgb.width,
                                 0,
                                 rgb.height,
                                 TJPF_RGB,
                                 &bytes,
                                 &size,
                                 TJSAMP_420,
                                 kQuality,
                                 TJFLAG_FASTDCT);
  const std::unique_ptr<unsigned char, void (*)(unsigned char*)> owner(bytes, tjFree);
  check(failed == 0, "a picture can be written as JPEG");
  return {reinterpret_cast<const char*>(bytes), size};
}

std::string jpeg_of(const image::Picture& picture, const PixelBox& part, double scale) {
  const image::Rgb8 rgb = image::rgb8_from_picture(picture, part);
  if (scale >= 1) return jpeg_of(rgb);
  const auto scaled = [&](int px) {
    return std::max(1, static_cast<int>(std::lround(px * scale)));
  };
  return jpeg_of(drawing::resized(rgb, scaled(rgb.width), scaled(rgb.height), cv::INTER_AREA));
}

}  // namespace airtruth::session
