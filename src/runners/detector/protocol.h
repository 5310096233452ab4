// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "runners/detector/detector.h"

// The messages between airtruth and a detector's program, as text (docs/detector-protocol.md). Each
// is one line, a JSON object.
namespace airtruth::detector {

// The number of the protocol's version.
inline constexpr int kProtocol = 1;
// More in one frame are taken for an error of the program.
inline constexpr std::size_t kMostInAnAnswer = 100'000;

enum class SampleOrder { kRgb, kGray };
enum class FramesBy { kPipe, kSharedMemory };

struct Hello {
  SampleOrder samples = SampleOrder::kRgb;
  FramesBy frames = FramesBy::kPipe;
  int bytes_per_pixel() const { return samples == SampleOrder::kRgb ? 3 : 1; }
};
// Throws process::Failure for what is no hello.
Hello hello_of(std::string_view line);

// `shared_memory` is the path of a file; "" where frames come over the pipe.
std::string begin_line(const SequenceInput& sequence, const std::string& shared_memory);
// `bytes` of samples follow over the pipe, or lie in shared memory.
std::string frame_line(const FrameInput& frame, std::size_t bytes);
inline constexpr std::string_view kQuitLine = "{\"quit\":true}\n";

// The detections of an answer to the frame with that index. Throws process::Failure.
std::vector<results::Detection> detections_of(std::string_view line, std::int64_t index);

}  // namespace airtruth::detector
