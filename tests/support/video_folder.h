// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdlib>
#include <string>

#include <gtest/gtest.h>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "picture/video/reader.h"
#include "support/error_of.h"
#include "support/ffmpeg.h"
#include "support/temporary_folder.h"

// What the tests of video files have in common.
namespace airtruth::video {

// A folder in which the ffmpeg program makes and reads files.
class Video : public testing::Test {
 protected:
  void ffmpeg(const std::string& arguments) const { test_support::ffmpeg(folder_, arguments); }
  std::string raw(const fs::path& video, const std::string& pixel_format) const {
    ffmpeg("-i '" + video.string() + "' -f rawvideo -fps_mode passthrough -pix_fmt " +
           pixel_format + " raw.bin");
    return read_file(folder_ / "raw.bin");
  }
  std::string probe(const fs::path& video, const std::string& entries) const {
    const std::string command = "cd '" + folder_.string() +
                                "' && ffprobe -v error -select_streams v -show_entries " + entries +
                                " -of csv=p=0 '" + video.string() + "' > probe.txt";
    EXPECT_EQ(std::system(command.c_str()), 0);
    return read_file(folder_ / "probe.txt");
  }

 private:
  test_support::TemporaryFolder temporary_;

 protected:
  const fs::path folder_ = temporary_.path();
};

inline std::string planes_of(const image::Picture& picture) {
  std::string bytes;
  for (std::size_t i = 0; i < static_cast<std::size_t>(picture.plane_count); ++i)
    for (int y = 0; y < picture.planes[i].height; ++y)
      bytes.append(reinterpret_cast<const char*>(picture.planes[i].row(y)),
                   static_cast<std::size_t>(picture.planes[i].width));
  return bytes;
}

inline std::string all_planes(Reader& reader, int* frames = nullptr) {
  std::string bytes;
  while (const auto frame = reader.next()) {
    bytes += planes_of(frame->picture);
    if (frames != nullptr) ++*frames;
  }
  return bytes;
}

inline std::string error_of(const fs::path& path, const ReaderOptions& options = {}) {
  return test_support::error_of([&] { Reader reader(path, options); });
}

}  // namespace airtruth::video
