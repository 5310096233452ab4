// SPDX-License-Identifier: Apache-2.0
#include <string>

#include <png.h>

#include "aircraft/texture_file/picture_kinds.h"
#include "foundation/base/error.h"

namespace airtruth::aircraft {
namespace {

// libpng's own state, freed however the reading ends.
class PngImage {
 public:
  PngImage() { image_.version = PNG_IMAGE_VERSION; }
  ~PngImage() { png_image_free(&image_); }
  PngImage(const PngImage&) = delete;
  PngImage& operator=(const PngImage&) = delete;
  png_image* operator->() { return &image_; }
  png_image* get() { return &image_; }
  [[noreturn]] void fail() const {
    throw Error(std::string("is a PNG file with a fault: ") + image_.message);
  }

 private:
  png_image image_{};
};

}  // namespace

bool is_png(std::string_view bytes) { return bytes.starts_with("\x89PNG\r\n\x1a\n"); }

Picture read_png(std::string_view bytes, const PictureLimits& limits) {
  PngImage image;
  if (png_image_begin_read_from_memory(image.get(), bytes.data(), bytes.size()) == 0) image.fail();
  Picture picture = blank_picture(image->width, image->height, limits);
  image->format = PNG_FORMAT_RGBA;
  // A negative stride: the last row of the file comes first.
  const auto stride = -static_cast<png_int_32>(4 * picture.width);
  if (png_image_finish_read(image.get(), nullptr, picture.rgba.data(), stride, nullptr) == 0)
    image.fail();
  return picture;
}

}  // namespace airtruth::aircraft
