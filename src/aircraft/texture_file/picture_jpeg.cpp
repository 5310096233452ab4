// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <string>

#include <turbojpeg.h>

#include "aircraft/texture_file/picture_kinds.h"
#include "foundation/base/error.h"

namespace airtruth::aircraft {
namespace {

struct CloseJpeg {
  void operator()(void* handle) const { tjDestroy(handle); }
};

[[noreturn]] void fail_jpeg(void* handle) {
  throw Error(std::string("is a JPEG file with a fault: ") + tjGetErrorStr2(handle));
}

}  // namespace

bool is_jpeg(std::string_view bytes) { return bytes.starts_with("\xff\xd8\xff"); }

Picture read_jpeg(std::string_view bytes, const PictureLimits& limits) {
  const std::unique_ptr<void, CloseJpeg> handle(tjInitDecompress());
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

}  // namespace airtruth::aircraft
