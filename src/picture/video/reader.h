// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "foundation/base/error.h"
#include "foundation/base/log.h"
#include "foundation/image/picture.h"

// Reads videos frame by frame.
//
// Example: a clip of 322 frames at 30 frames/s, read from frame 300 on, gives 22 frames. The first
// has the index 0 and the time 0 s; the last has the index 21 and the time 21 / 30 = 0.7 s.
//
//   Reader reader("clip.mp4", {.first_frame = 300});
//   while (const std::optional<Frame> frame = reader.next()) ...
namespace airtruth::video {

// One frame of a video in the decoder's own planes. The picture is upright: the rotation of the
// stream's metadata is already applied, without loss.
struct Frame {
  // Counts from the first frame that the reader hands out.
  std::int64_t index = 0;
  // Time stamp of the stream, in units of StreamInfo::time_base.
  std::int64_t pts = 0;
  // Seconds from the first frame that the reader hands out.
  double time_s = 0;
  // True for the first frame after a cut (foundation/image/cuts.h); needs ReaderOptions::with_cuts.
  bool begins_shot = false;
  // True where the decoder reported corrupt data or concealed errors in it.
  bool damaged = false;
  // Mean of H.264's QP over the frame's blocks, whose steps are in codes of 8 bits for any depth;
  // needs ReaderOptions::with_quantiser.
  std::optional<double> quantiser;
  image::Picture picture;
};

// A fraction, as containers store rates and clocks.
struct Rational {
  int num = 0;
  int den = 1;
  double value() const { return static_cast<double>(num) / den; }
};

// Properties of a video stream. Sizes are those after rotation.
struct StreamInfo {
  int width = 0;
  int height = 0;
  // Where the matrix is untagged, BT.601 is assumed below 720 lines, else BT.709 (the common rule
  // of players). Where the range is untagged, limited is assumed, or full for JPEG kinds (yuvj*),
  // RGB and grey stills.
  image::Colour colour;
  // AVColorPrimaries and AVColorTransferCharacteristic as tagged; 2: unspecified.
  int primaries_tag = 2;
  int transfer_tag = 2;
  Rational time_base{1, 30};
  // Average rate, in frames a second.
  Rational frame_rate{30, 1};
  bool variable_frame_rate = false;
  // False for numbered images whose rate ReaderOptions does not state: frame_rate is then libav's
  // own 25, and times follow from it.
  bool is_rate_stated = true;
  // True for numbered images, which have no rate of their own.
  bool is_of_pictures = false;
  Rational sample_aspect{1, 1};
  // The rotation that the reader has applied, clockwise: 0, 90, 180 or 270 degrees.
  int rotation_deg = 0;
  // Number of frames as the container gives it; 0: unknown.
  std::int64_t frame_count_estimate = 0;
  // False where it follows from the length of the container, which is that of its longest stream,
  // and the rate: Matroska and MPEG-TS state no number.
  bool is_frame_count_stated = false;
  // Name of the codec, for example "h264".
  std::string codec;
  // Name of the pixel format, for example "yuv420p".
  std::string pixel_format;
  // As read_tags() (metadata.h).
  std::map<std::string, std::string> tags;
};

// Throws Error where numbered pictures are given no rate, or --frame-rate is given for a video,
// which has its own. `rate_hz` is that which the user states.
void expect_rate(const std::filesystem::path& video,
                 const StreamInfo& info,
                 const std::optional<double>& rate_hz);

// What the reader delivers.
struct ReaderOptions {
  // The first frame that is handed out. Decoding begins at the key frame before it. Where the file
  // does not say when each of its frames is shown, all frames before it are decoded, with a
  // warning.
  std::int64_t first_frame = 0;
  // Largest number of frames; empty: to the end.
  std::optional<std::int64_t> frame_count;
  // Of numbered images, in frames a second.
  std::optional<double> picture_rate_hz = {};
  // Number of decoder threads; 0: one for each core. From the first sign of a fault on, a video is
  // read by one, from its beginning to the frame that is next and on: what libav conceals would
  // depend on the threads.
  int threads = 0;
  // True: the reader fills Frame::quantiser where the decoder exports it.
  bool with_quantiser = false;
  // True: the reader fills Frame::begins_shot. The decision needs the following frames, so the
  // reader holds two decoded frames back.
  bool with_cuts = false;
  // False: one picture is wanted, and no duration or rate. A picture file is then decoded once and
  // not twice.
  bool with_timing = true;
  // What states first_frame, for the message about one past the end.
  Where where = {};
};

// Reads a video (H.264, HEVC, MJPEG, MPEG-4, VP9, FFV1, ProRes, ... in mp4, mov, avi, mkv, webm) or
// numbered images ("frames/%04d.png", or a folder of numbered images), 8-bit 4:2:0, 4:2:2, 4:4:0,
// 4:4:4, grey or RGB. Deeper samples are reduced to 8 bits with a warning; palettes and 1-bit
// stills become RGB and grey. Other layouts (Bayer, floating point) are an Error whose message
// names a remedy. A display matrix (rotation, mirror) is applied.
//
// The constructor opens the file and decodes up to the first frame. It throws Error for a file that
// is missing, empty, not a video, audio only or without a frame that decodes, and for a first_frame
// past the end.
class Reader {
 public:
  explicit Reader(const std::filesystem::path& path,
                  const ReaderOptions& options = {},
                  Warn warn = {});
  ~Reader();
  Reader(Reader&&) noexcept;
  Reader& operator=(Reader&&) noexcept;

  const StreamInfo& info() const;
  // The next frame in presentation order; empty at the end. Corrupt packets are skipped, and the
  // frames that they affect are flagged `damaged`. At the end it warns of both, and of a file that
  // ends early (truncated). Throws Error only where the rest of the file cannot be read at all.
  std::optional<Frame> next();
  // The frame that is shown at a time of the clip; the last one for a later time. It is decoded
  // from the key frame before it, so that a long clip costs no more than a short one; of MPEG's
  // streams all packets are read once, and where their time stamps begin anew it is decoded from
  // the first frame on. Its index is that of a clip of constant rate. at() may be called for any
  // times in any order, and next() no more after it. Empty where the file cannot be read there.
  std::optional<Frame> at(double time_s);
  // After the first next(): when each of at most `most` frames from that one on is shown, in
  // seconds from it. They are found without decoding; empty where the file does not say.
  std::vector<double> times_s(std::int64_t most) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

// A number of frames that is larger than that of any video.
constexpr std::int64_t kAllFrames = std::int64_t{1} << 60;
// Whether frames from 0 on at these times have this rate; rounded time stamps are no other rate.
bool are_of_rate(std::span<const double> times_s, double rate_hz);

// Time of a frame in seconds from the video's first frame. `options` states the frame and the rate
// of numbered images. Errors as of Reader.
double time_of_first_frame_s(const std::filesystem::path& path, const ReaderOptions& options);

}  // namespace airtruth::video
