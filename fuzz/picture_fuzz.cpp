// SPDX-License-Identifier: Apache-2.0
// PNG, JPEG, WebP, BMP, SGI and TGA: anything but an Error is a finding.
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "aircraft/texture_file/picture.h"
#include "foundation/base/error.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  try {
    (void)airtruth::texture_file::read_picture(bytes, {.side_px = 1024, .pixels = 1 << 18});
  } catch (const airtruth::Error&) {
  }
  return 0;
}
