// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

// What a video file holds beside its pictures and sound.
namespace airtruth::video {

// The tags of a video file and of its video stream, with keys in lower case, as cameras write them
// ("com.apple.quicktime.model", "encoder"). A stream's tag takes precedence. Empty where the path
// is no regular file, or a list of pictures. Throws Error where the file cannot be opened.
std::map<std::string, std::string> read_tags(const std::filesystem::path& path);

// A packet of a GoPro's telemetry track ("gpmd"), undecoded.
struct TelemetryPacket {
  // Seconds from the first frame of the video.
  double begin_s = 0;
  double end_s = 0;
  std::vector<std::uint8_t> bytes;
};

// All packets of the file, in their order; empty where the file has no such track, is a list of
// pictures, or the path is no regular file. Throws Error where the file cannot be opened.
std::vector<TelemetryPacket> read_telemetry(const std::filesystem::path& path);

// A subtitle of a video's own track of text.
struct Subtitle {
  // Seconds from the first frame of the video.
  double begin_s = 0;
  std::string text;
};

// The subtitles of the first track of text (mov_text, SubRip) in their order; empty where the file
// has none, is a list of pictures, or the path is no regular file. Throws Error where the file
// cannot be opened.
std::vector<Subtitle> read_subtitles(const std::filesystem::path& path);

}  // namespace airtruth::video
