// SPDX-License-Identifier: Apache-2.0
// Compares the pictures with the output of the ffmpeg program for the same two.
#include "picture/video/patch_codec.h"

#include <cmath>
#include <cstdlib>

#include <gtest/gtest.h>
#include <unistd.h>

#include "foundation/base/files.h"

namespace airtruth::video {
namespace {

using image::Chroma;
using image::Picture;

// A soft sky with a dark bar at `x`, in all planes.
Picture bar_at(int x, int width, int height, Chroma chroma) {
  Picture picture = image::make_picture(width, height, {chroma});
  for (std::size_t i = 0; i < static_cast<std::size_t>(picture.plane_count); ++i) {
    const int shift = i > 0 ? image::log2_chroma_width(chroma) : 0;
    for (int v = 0; v < picture.planes[i].height; ++v)
      for (int u = 0; u < picture.planes[i].width; ++u) {
        const bool in_bar = u >= x >> shift && u < (x + 20) >> shift && v > 8 && v < 14;
        picture.planes[i].row(v)[u] = static_cast<std::uint8_t>((i == 0 ? 170 + v / 4 : 120) -
                                                                (in_bar ? 60 + 3 * (u % 5) : 0));
      }
  }
  return picture;
}

double rms_difference(const Picture& a, const Picture& b) {
  double sum = 0;
  for (int y = 0; y < a.height; ++y)
    for (int x = 0; x < a.width; ++x)
      sum += std::pow(static_cast<double>(a.luma().row(y)[x]) - b.luma().row(y)[x], 2);
  return std::sqrt(sum / (a.width * a.height));
}

std::string bytes_of(const Picture& picture) {
  std::string bytes;
  for (std::size_t i = 0; i < static_cast<std::size_t>(picture.plane_count); ++i)
    for (int y = 0; y < picture.planes[i].height; ++y)
      bytes.append(reinterpret_cast<const char*>(picture.planes[i].row(y)),
                   static_cast<std::size_t>(picture.planes[i].width));
  return bytes;
}

std::string by_the_ffmpeg_program(const Picture& reference,
                                  const Picture& patch,
                                  const char* layout,
                                  int quantiser) {
  const fs::path folder =
      fs::temp_directory_path() / ("airtruth_patch_codec_" + std::to_string(::getpid()));
  fs::create_directories(folder);
  write_file(folder / "in.yuv", bytes_of(reference) + bytes_of(patch));
  const std::string size = std::to_string(patch.width) + "x" + std::to_string(patch.height);
  const std::string raw = std::string(" -f rawvideo -pix_fmt ") + layout + " -s " + size + " ";
  const std::string command =
      "cd '" + folder.string() + "' && ffmpeg -nostdin -v error -y" + raw +
      "-i in.yuv -c:v libx264 -threads 1 -tune zerolatency -refs 1 -i_qfactor 0.1 -qp " +
      std::to_string(quantiser) + " -x264-params cpu-independent=1:scenecut=0:weightp=0 out.mkv" +
      " && ffmpeg -nostdin -v error -y -i out.mkv -f rawvideo -pix_fmt " + layout + " out.yuv";
  EXPECT_EQ(std::system(command.c_str()), 0) << command;
  const std::string both = read_file(folder / "out.yuv");
  fs::remove_all(folder);
  return both.substr(both.size() / 2);
}

TEST(PatchCodec, MakesWhatTheFfmpegProgramMakes) {
  // Grey is omitted: the program stretches its range.
  const std::pair<Chroma, const char*> layouts[] = {
      {Chroma::k420, "yuv420p"}, {Chroma::k422, "yuv422p"}, {Chroma::k444, "yuv444p"}};
  for (const auto& [chroma, name] : layouts) {
    const Picture reference = bar_at(13, 96, 48, chroma);
    const Picture patch = bar_at(16, 96, 48, chroma);
    PatchCodec codec(27);
    EXPECT_EQ(bytes_of(codec.coded(patch, reference)),
              by_the_ffmpeg_program(reference, patch, name, 27))
        << name;
  }
}

TEST(PatchCodec, GivesTheSameWhateverItCodedBefore) {
  const Picture reference = bar_at(13, 96, 48, Chroma::k420);
  const Picture patch = bar_at(17, 96, 48, Chroma::k420);
  PatchCodec codec(30);
  const std::string first = bytes_of(codec.coded(patch, reference));
  for (int i = 0; i < 6; ++i) {
    const Picture other = bar_at(5 + i, 64 + 16 * i, 32, Chroma::k420);
    codec.coded(other, other);
  }
  EXPECT_EQ(bytes_of(codec.coded(patch, reference)), first);
}

TEST(PatchCodec, LosesMoreWithAHigherQuantiserAndNothingThatTheReferenceHas) {
  const Picture reference = bar_at(13, 96, 48, Chroma::k420);
  const Picture patch = bar_at(60, 96, 48, Chroma::k420);
  double before = 0;
  for (const int quantiser : {12, 24, 36, 48}) {
    PatchCodec codec(quantiser);
    const double lost = rms_difference(codec.coded(patch, reference), patch);
    EXPECT_GT(lost, before) << quantiser;
    before = lost;
  }
  EXPECT_LT(rms_difference(PatchCodec(36).coded(patch, patch), patch), 1.5);
  const Picture grey = bar_at(13, 96, 48, Chroma::kNone);
  EXPECT_LT(rms_difference(PatchCodec(20).coded(grey, grey), grey), 1);
}

TEST(PatchCodec, CodesEveryLayoutButTheOneThatH264Lacks) {
  EXPECT_TRUE(PatchCodec::can_code({Chroma::k420}));
  EXPECT_FALSE(PatchCodec::can_code({Chroma::k440}));
}

}  // namespace
}  // namespace airtruth::video
