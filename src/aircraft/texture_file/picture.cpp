// SPDX-License-Identifier: Apache-2.0
#include "aircraft/texture_file/picture.h"

#include <memory>
#include <string>

#include <png.h>
#include <turbojpeg.h>
#include <webp/decode.h>

#include "aircraft/texture_file/picture_formats.h"
#include "foundation/base/error.h"
#include "foundation/base/huge_pages.h"

namespace airtruth::texture_file {
namespace {

void expect_png(int is_sound, const png_image& image) {
  if (is_sound == 0) throw Error(std::string("is a PNG file with a fault: ") + image.message);
}

Picture read_png(std::string_view bytes, const PictureLimits& limits) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  // However the reading ends.
  const std::unique_ptr<png_image, decltype(&png_image_free)> freed(&image, &png_image_free);
  expect_png(png_image_begin_read_from_memory(&image, bytes.data(), bytes.size()), image);
  Picture picture = blank_picture(image.width, image.height, limits);
  image.format = PNG_FORMAT_RGBA;
  image.flags |= PNG_IMAGE_FLAG_16BIT_sRGB;  // where no gamma is stated; libpng's own is linear
  // A negative stride: the last row of the file comes first.
  const auto stride = -static_cast<png_int_32>(4 * picture.width);
  expect_png(png_image_finish_read(&image, nullptr, picture.rgba.data(), stride, nullptr), image);
  return picture;
}

[[noreturn]] void fail_jpeg(void* handle) {
  throw Error(std::string("is a JPEG file with a fault: ") + tjGetErrorStr2(handle));
}

Picture read_jpeg(std::string_view bytes, const PictureLimits& limits) {
  const std::unique_ptr<void, decltype(&tjDestroy)> handle(tjInitDecompress(), &tjDestroy);
  if (!handle) throw Error("is a JPEG file, for which libjpeg-turbo has no memory");
  const auto* data = reinterpret_cast<const unsigned char*>(bytes.data());
  const auto size = static_cast<unsigned long>(bytes.size());
  int width = 0;
  int height = 0;
  int subsampling = 0;
  int colours = 0;
  if (tjDecompressHeader3(handle.get(), data, size, &width, &height, &subsampling, &colours) != 0)
    fail_jpeg(handle.get());
  if (colours == TJCS_CMYK || colours == TJCS_YCCK)
    throw Error("is a JPEG file of printing colours (CMYK); expected RGB or gray");
  if (width <= 0 || height <= 0) throw Error("is a JPEG file without pixels");
  Picture picture =
      blank_picture(static_cast<std::uint64_t>(width), static_cast<std::uint64_t>(height), limits);
  const int flags = TJFLAG_BOTTOMUP | TJFLAG_LIMITSCANS | TJFLAG_ACCURATEDCT;
  if (tjDecompress2(
          handle.get(), data, size, picture.rgba.data(), width, 0, height, TJPF_RGBA, flags) != 0)
    fail_jpeg(handle.get());
  return picture;
}

Picture read_webp(std::string_view bytes, const PictureLimits& limits) {
  const auto* data = reinterpret_cast<const std::uint8_t*>(bytes.data());
  WebPDecoderConfig config;
  if (WebPInitDecoderConfig(&config) == 0 ||
      WebPGetFeatures(data, bytes.size(), &config.input) != VP8_STATUS_OK)
    throw Error("is a WebP file with a fault");
  if (config.input.has_animation != 0) throw Error("is a moving WebP file; expected one picture");
  Picture picture = blank_picture(static_cast<std::uint64_t>(config.input.width),
                                  static_cast<std::uint64_t>(config.input.height),
                                  limits);
  config.options.flip = 1;  // the last row of the file comes first
  config.output.colorspace = MODE_RGBA;
  config.output.is_external_memory = 1;
  config.output.u.RGBA = {picture.rgba.data(), 4 * picture.width, picture.rgba.size()};
  if (WebPDecode(data, bytes.size(), &config) != VP8_STATUS_OK)
    throw Error("is a WebP file with a fault");
  return picture;
}

}  // namespace

Picture blank_picture(std::uint64_t width, std::uint64_t height, const PictureLimits& limits) {
  const auto side = static_cast<std::uint64_t>(limits.side_px);
  const std::string size = std::to_string(width) + " x " + std::to_string(height) + " pixels";
  if (width == 0 || height == 0) throw Error("is a picture of " + size + "; expected at least one");
  if (width > side || height > side || width * height > limits.pixels)
    throw Error("is a picture of " + size + "; expected at most " + std::to_string(side) +
                " on a side and " + std::to_string(limits.pixels) + " left in all");
  Picture picture;
  picture.width = static_cast<int>(width);
  picture.height = static_cast<int>(height);
  const auto bytes = static_cast<std::size_t>(width * height * 4);
  picture.rgba.reserve(bytes);
  ask_for_huge_pages(picture.rgba.data(), bytes);
  picture.rgba.resize(bytes);
  return picture;
}

Picture read_picture(std::string_view bytes, const PictureLimits& limits) {
  if (bytes.starts_with("\x89PNG\r\n\x1a\n")) return read_png(bytes, limits);
  if (bytes.starts_with("\xff\xd8\xff")) return read_jpeg(bytes, limits);
  if (bytes.starts_with("\x01\xda")) return read_sgi(bytes, limits);
  if (bytes.starts_with("BM")) return read_bmp(bytes, limits);
  if (bytes.starts_with("RIFF") && bytes.size() > 12 && bytes.substr(8, 4) == "WEBP")
    return read_webp(bytes, limits);
  if (auto picture = read_tga(bytes, limits)) return *std::move(picture);
  throw Error("is no picture that can be read; expected PNG, JPEG, WebP, BMP, SGI or TGA");
}

}  // namespace airtruth::texture_file
