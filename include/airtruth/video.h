// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include <airtruth/error.h>
#include <airtruth/export.h>
#include <airtruth/picture.h>

namespace airtruth {

struct VideoInfo {
  int width = 0;
  int height = 0;
  double frame_rate_hz = 0;
  // Number of frames as the container gives it; 0: unknown.
  std::int64_t frame_count_estimate = 0;
  // Names of FFmpeg, for example "h264" and "yuv420p".
  std::string codec;
  std::string pixel_format;
};

struct VideoFrame {
  // Counts from the first frame that the reader hands out.
  std::int64_t index = 0;
  double time_s = 0;
  // True where the decoder reported corrupt data or concealed errors.
  bool damaged = false;
  FramePicture picture;
};

// Reads a video (H.264, HEVC, MJPEG, MPEG-4, VP9, FFV1, ProRes, ... in mp4, mov, avi, mkv, webm) or
// numbered images ("frames/%04d.png", or a folder of them) frame by frame. The rotation of the
// stream's metadata is applied. Deeper samples are reduced to 8 bits.
//
// Example: a clip of 322 frames, read from frame 300 on, gives 22 frames; the first has the index 0
// and the time 0 s.
//   VideoReader reader("clip.mp4", 300);
//   while (const auto frame = reader.next()) ...
class AIRTRUTH_API VideoReader {
 public:
  // Throws Error for a file that is missing, empty, no video or without a frame that decodes, and
  // for a first_frame below 0 or past the end.
  explicit VideoReader(const std::filesystem::path& video,
                       std::int64_t first_frame = 0,
                       const Warn& warn = {});
  ~VideoReader();
  VideoReader(VideoReader&&) noexcept;
  VideoReader& operator=(VideoReader&&) noexcept;

  VideoInfo info() const;
  // The next frame in presentation order; empty at the end. Throws Error where the rest of the file
  // cannot be read at all.
  std::optional<VideoFrame> next();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace airtruth
