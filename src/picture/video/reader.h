// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "foundation/base/log.h"
#include "picture/video/frame.h"

namespace airtruth::video {

struct Rational {
  int num = 0;
  int den = 1;
  double value() const { return static_cast<double>(num) / den; }
};

// What a stream is. Sizes are after rotation.
struct StreamInfo {
  int width = 0;
  int height = 0;
  image::Colour colour;
  bool matrix_guessed =
      false;  // untagged: BT.601 below 720 lines, else BT.709 (the common rule of players)
  bool range_guessed = false;  // untagged: limited, or full for JPEG kinds (yuvj*) and RGB
  int primaries_tag =
      2;  // AVColorPrimaries and AVColorTransferCharacteristic as tagged; 2 = unspecified
  int transfer_tag = 2;
  Rational time_base{1, 30};
  Rational frame_rate{30, 1};  // average
  bool variable_frame_rate = false;
  Rational sample_aspect{1, 1};
  int rotation_deg = 0;                   // what was applied: 0, 90, 180, 270 clockwise
  std::int64_t frame_count_estimate = 0;  // 0 = unknown
  std::string codec;                      // "h264"
  std::string pixel_format;               // "yuv420p"
};

struct ReaderOptions {
  std::int64_t first_frame = 0;             // frames before it are decoded and dropped
  std::optional<std::int64_t> frame_count;  // else to the end
  int threads = 0;                          // 0 = one per core
  bool with_quantiser = false;              // Frame::quantiser, where the decoder tells it
  // Frame::begins_shot. What comes after a frame says whether it begins a shot: two frames are held
  // that are decoded and not handed out.
  bool with_cuts = false;
};

// Reads a video (H.264, HEVC, MJPEG, MPEG-4, VP9, FFV1, ProRes, ... in mp4, mov, avi, mkv, webm) or
// numbered images ("frames/%04d.png", or a folder of numbered images), 8-bit 4:2:0, 4:2:2, 4:4:0,
// 4:4:4, grey or RGB. Deeper samples are taken to 8 bits with a warning; palettes and 1-bit stills
// become RGB and grey; other layouts (Bayer, floating point) are an Error that says what to do. A
// display matrix (rotation, mirror) is applied. The constructor opens the file and decodes up to
// the first frame, so that what is wrong with it is said there: missing, empty, not a video, audio
// only, no frame that decodes, first_frame past the end.
class Reader {
 public:
  explicit Reader(const std::filesystem::path& path,
                  const ReaderOptions& options = {},
                  Warn warn = {});
  ~Reader();
  Reader(Reader&&) noexcept;
  Reader& operator=(Reader&&) noexcept;

  const StreamInfo& info() const;
  // The next frame in presentation order; empty at the end. Corrupt packets are passed over and the
  // frames they touch are flagged `damaged`. Throws Error only where the file can no longer be read
  // at all.
  std::optional<Frame> next();
  // After the end: how many packets could not be decoded, and whether the file ends early
  // (truncated).
  std::int64_t corrupt_packets() const;
  bool ends_early() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace airtruth::video
