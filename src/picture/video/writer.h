// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "picture/video/frame.h"
#include "picture/video/reader.h"

namespace airtruth::video {

enum class Format {
  kMp4,
  kMkv,
  kAvi,
  kPng
};  // H.264 in mp4, FFV1 in mkv (lossless), MJPEG in avi, numbered png

// "mp4", "mkv", "avi", "png"; throws Error naming the four for anything else.
Format format_from_name(std::string_view name);
// By a file's ending; Error that names the endings where it has none or another.
Format format_of_file(const std::filesystem::path& path);
const char* extension(Format format);  // ".mp4"; for png "" (a folder of 000000.png ...)

struct WriterOptions {
  Format format = Format::kMp4;
  int quality = 18;  // H.264: CRF 0..51; MJPEG: qscale 1..31 is derived from the same scale;
                     // lossless: ignored
  std::string preset = "veryfast";  // x264's speed against size
  int threads = 0;                  // 0: as many as the encoder likes
};

// Writes pictures of one size and colour with their time stamps, tagged with the colour they have.
// The file is written under part_path(path) and renamed by finish(); a Writer destroyed before
// finish() leaves nothing behind. H.264 keeps the picture's own chroma layout (High, High 4:2:2 or
// High 4:4:4 profile; odd sizes as they are where the layout allows it, else Error that names a
// format that can); RGB becomes 4:4:4 BT.709 full range in mp4 and avi, and stays RGB in mkv and
// png. avi has one frame rate and full-range samples alone; png is sRGB.
// mkv keeps time stamps in whole milliseconds.
class Writer {
 public:
  Writer(const std::filesystem::path& path, const StreamInfo& info, const WriterOptions& options);
  ~Writer();
  Writer(Writer&&) noexcept;
  Writer& operator=(Writer&&) noexcept;

  void write(const Frame&
                 frame);  // in presentation order. Throws Error, for example when the disk is full
  void finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace airtruth::video
