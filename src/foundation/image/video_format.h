// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "foundation/base/names.h"

// The choices of a written video, as files and command lines name them.
namespace airtruth::video {

// H.264 in mp4, FFV1 in mkv (lossless), MJPEG in avi, or numbered png.
enum class Format { kMp4, kMkv, kAvi, kPng };

constexpr auto enum_names(Format) {
  return std::to_array<EnumName<Format>>(
      {{Format::kMp4, "mp4"}, {Format::kMkv, "mkv"}, {Format::kAvi, "avi"}, {Format::kPng, "png"}});
}

// Who encodes H.264. libx264 gives the same bytes on every machine; the hardware of a machine gives
// its own. kAuto is the first of NVENC, VAAPI and Quick Sync that can be opened, else libx264.
enum class Encoder { kX264, kAuto, kNvenc, kVaapi, kQsv };

constexpr auto enum_names(Encoder) {
  return std::to_array<EnumName<Encoder>>({{Encoder::kX264, "x264"},
                                           {Encoder::kAuto, "auto"},
                                           {Encoder::kNvenc, "nvenc"},
                                           {Encoder::kVaapi, "vaapi"},
                                           {Encoder::kQsv, "qsv"}});
}

}  // namespace airtruth::video
