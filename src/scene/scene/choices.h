// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "foundation/base/names.h"

// The choices that a scene file states as a word: each is an enum with the words of the file. The
// words stand in no other place. lens::ModelKind and Readout are choices of [lens] and [shutter].
namespace airtruth::scene {

// [motion] model: how the camera's shake is modelled. kAuto means kRotation, and kHomography for
// the compositing method kChromaKey.
enum class MotionModel { kAuto, kRotation, kHomography, kNone };

constexpr auto enum_names(MotionModel) {
  return std::to_array<EnumName<MotionModel>>({{MotionModel::kAuto, "auto"},
                                               {MotionModel::kRotation, "rotation"},
                                               {MotionModel::kHomography, "homography"},
                                               {MotionModel::kNone, "none"}});
}

// [motion] reference: the pose against which shake is measured.
enum class MotionReference { kFirstFrame, kSmoothed };

constexpr auto enum_names(MotionReference) {
  return std::to_array<EnumName<MotionReference>>(
      {{MotionReference::kFirstFrame, "first_frame"}, {MotionReference::kSmoothed, "smoothed"}});
}

// [composite] method: how a rendered aircraft is put into the frame.
enum class CompositeMethod { kMatte, kChromaKey };

constexpr auto enum_names(CompositeMethod) {
  return std::to_array<EnumName<CompositeMethod>>(
      {{CompositeMethod::kMatte, "matte"}, {CompositeMethod::kChromaKey, "chroma-key"}});
}

// [output] video: the format of the written video; kPng is a folder of pictures.
enum class OutputVideo { kMp4, kMkv, kAvi, kPng };

constexpr auto enum_names(OutputVideo) {
  return std::to_array<EnumName<OutputVideo>>({{OutputVideo::kMp4, "mp4"},
                                               {OutputVideo::kMkv, "mkv"},
                                               {OutputVideo::kAvi, "avi"},
                                               {OutputVideo::kPng, "png"}});
}

// [output] encoder: who encodes H.264. kAuto is the machine's hardware where it has one of the
// others, else kX264, which alone gives the same bytes on every machine.
enum class OutputEncoder { kX264, kAuto, kNvenc, kVaapi, kQsv };

constexpr auto enum_names(OutputEncoder) {
  return std::to_array<EnumName<OutputEncoder>>({{OutputEncoder::kX264, "x264"},
                                                 {OutputEncoder::kAuto, "auto"},
                                                 {OutputEncoder::kNvenc, "nvenc"},
                                                 {OutputEncoder::kVaapi, "vaapi"},
                                                 {OutputEncoder::kQsv, "qsv"}});
}

}  // namespace airtruth::scene
