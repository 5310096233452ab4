// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "foundation/base/error.h"
#include "foundation/image/video_format.h"
#include "picture/video/reader.h"

namespace airtruth::video {

using Format = image::VideoFormat;
using Encoder = image::VideoEncoder;

// The format of a file's ending. A missing or other ending is an Error that lists the endings.
Format format_of_file(const std::filesystem::path& path);
// For example ".mp4"; "" for png (a folder of 000000.png ...).
const char* extension(Format format);

struct WriterOptions {
  Format format = Format::kMp4;
  // H.264: CRF 0..51. MJPEG: its qscale 1..31 is derived from the same scale. Lossless formats
  // ignore it.
  int quality = 18;
  // For mp4: the longest time between two key frames, in seconds. A reader that wants one frame
  // decodes all since the key frame before it.
  double keyframe_s = 0.5;
  // Number of encoder threads of FFV1 and MJPEG; 0: one for each core. The bytes do not depend on
  // it. H.264 has a number of its own, on which its bytes do depend.
  int threads = 0;
  // For mp4.
  Encoder encoder = Encoder::kX264;
  // The place that names the encoder, for the Error where it cannot be opened.
  Where encoder_where;
};

// Throws Error at `where` for a video that the format cannot hold, as a Writer does.
void check_output(const StreamInfo& info, Format format, const Where& where);

// Writes pictures of one size and colour with their time stamps, tagged with their colour. The file
// is written under part_path(path) and renamed by finish(); a Writer that is destroyed before
// finish() leaves nothing behind.
//
// H.264 keeps the picture's own chroma layout (High, High 4:2:2 or High 4:4:4 profile). Odd sizes
// are kept where the layout allows them; otherwise an Error names a format that supports them. RGB
// becomes 4:4:4 BT.709 full range in mp4 and avi, and stays RGB in mkv and png. avi has
// only full-range samples, and one frame rate: a variable one is an Error, at the latest at the
// frame whose time departs by more than a frame (a frame and a half where time stamps are coarse,
// as whole milliseconds). png is sRGB, without
// times. mkv keeps time stamps in whole milliseconds.
class Writer {
 public:
  Writer(const std::filesystem::path& path, const StreamInfo& info, const WriterOptions& options);
  ~Writer();

  // Frames come in presentation order. Throws Error, for example when the disk is full.
  void write(const Frame& frame);
  void finish();
  // libav's name of the encoder, such as "libx264"; "png" for numbered png.
  const std::string& encoder() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace airtruth::video
