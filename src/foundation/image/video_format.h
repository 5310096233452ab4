// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "foundation/base/names.h"

// The choices of a written video, as files and command lines name them.
namespace airtruth::image {

// H.264 in mp4, FFV1 in mkv (lossless), MJPEG in avi, or numbered png.
enum class VideoFormat { kMp4, kMkv, kAvi, kPng };

constexpr auto enum_names(VideoFormat) {
  return std::to_array<EnumName<VideoFormat>>({{VideoFormat::kMp4, "mp4"},
                                               {VideoFormat::kMkv, "mkv"},
                                               {VideoFormat::kAvi, "avi"},
                                               {VideoFormat::kPng, "png"}});
}

// Who encodes H.264. libx264 gives the same bytes on every machine; the hardware of a machine gives
// its own. kAuto is the first of NVENC, VAAPI and Quick Sync that can be opened, else libx264.
enum class VideoEncoder { kX264, kAuto, kNvenc, kVaapi, kQsv };

constexpr auto enum_names(VideoEncoder) {
  return std::to_array<EnumName<VideoEncoder>>({{VideoEncoder::kX264, "x264"},
                                                {VideoEncoder::kAuto, "auto"},
                                                {VideoEncoder::kNvenc, "nvenc"},
                                                {VideoEncoder::kVaapi, "vaapi"},
                                                {VideoEncoder::kQsv, "qsv"}});
}

}  // namespace airtruth::image
