// SPDX-License-Identifier: Apache-2.0
// What the intruder does not touch is the background's, bit for bit: decode the input and the
// lossless output and compare.
#include <cstdlib>

#include <gtest/gtest.h>

#include "foundation/base/files.h"
#include "picture/video/reader.h"
#include "sequence/demo/demo.h"
#include "sequence/pipeline/render.h"
#include "sequence/replay/finished.h"
#include "support/shared_folder.h"
#include "support/temporary_folder.h"

namespace airtruth::pipeline {
namespace {

class Untouched : public testing::Test {
 protected:
  // A 737 and a 172 before this video's camera.
  scene::Scene scene_over(const fs::path& video, int first_frame, int frame_count) const {
    return scene::parse_scene(
        "name = \"clip\"\n[background]\nvideo = \"" + video.string() + "\"\nfirst_frame = " +
            std::to_string(first_frame) + "\nframe_count = " + std::to_string(frame_count) +
            "\n[lens]\nmodel = \"pinhole\"\nvertical_fov_deg = 50\n"
            "[camera]\nposition_ned_m = [0, 0, -150]\n"
            "attitude_yaw_pitch_roll_deg = [0, 0, 0]\n"
            "[motion]\nreference = \"smoothed\"\n"
            "[[intruder]]\nid = \"far\"\naircraft = \"738/738-Ryanair\"\n"
            "waypoints_ned_m = [[400, -80, -190], [410, 200, -195]]\nspeed_mps = 90\n"
            "[[intruder]]\nid = \"near\"\naircraft = \"c172/g-boix\"\n"
            "waypoints_ned_m = [[60, -10, -155], [70, 60, -160]]\nspeed_mps = 20\n"
            "[output]\nvideo = \"mkv\"\n",
        folder_ / "scene.toml");
  }

  // Samples that differ outside every visible box, and those that differ at all.
  std::pair<std::int64_t, std::int64_t> differing(const scene::Scene& scene) const {
    Options options;
    options.use_cache = false;
    options.overwrite = true;
    const replay::Finished finished = replay::open_finished(render(scene, folder_, options).folder);
    video::ReaderOptions as_rendered;
    as_rendered.first_frame = scene.background.first_frame;
    as_rendered.frame_count = scene.background.frame_count;
    video::Reader before(scene.background.video, as_rendered);
    video::Reader after(finished.video);
    std::int64_t outside = 0;
    std::int64_t all = 0;
    for (const annotation::Frame& truth : finished.truth.frames) {
      const auto a = before.next();
      const auto b = after.next();
      if (!a || !b || a->picture.plane_count != b->picture.plane_count) return {-1, -1};
      count(a->picture, b->picture, truth, outside, all);
    }
    return {outside, all};
  }

  static void count(const image::Picture& a,
                    const image::Picture& b,
                    const annotation::Frame& truth,
                    std::int64_t& outside,
                    std::int64_t& all) {
    for (std::size_t p = 0; p < static_cast<std::size_t>(a.plane_count); ++p) {
      const int sx = p == 0 ? 0 : image::log2_chroma_width(a.colour.chroma);
      const int sy = p == 0 ? 0 : image::log2_chroma_height(a.colour.chroma);
      for (int y = 0; y < a.planes[p].height; ++y) {
        for (int x = 0; x < a.planes[p].width; ++x) {
          if (a.planes[p].row(y)[x] == b.planes[p].row(y)[x]) continue;
          ++all;
          bool boxed = false;
          for (const auto& one : truth.intruders)
            boxed =
                boxed || (one.visible_box_px &&
                          intersection(*one.visible_box_px, {x << sx, y << sy, 1 << sx, 1 << sy}));
          outside += boxed ? 0 : 1;
        }
      }
    }
  }

  test_support::TemporaryFolder temporary_;
  fs::path folder_ = temporary_.path();
};

TEST_F(Untouched, InEveryPixelFormat) {
  synthetic::FlightOptions options;
  options.width = 322;
  options.height = 241;
  options.frame_count = 6;
  options.own_aircraft = false;
  demo::VirtualFlightOptions how;
  how.format = video::Format::kMkv;
  demo::write_flight(synthetic::Flight(options), folder_ / "flight.mkv", how);
  for (const char* format : {"yuv420p", "yuv422p", "yuv440p", "yuv444p", "gray", "bgr0"}) {
    const fs::path clip = folder_ / (std::string(format) + ".mkv");
    const std::string command = "ffmpeg -nostdin -v error -y -i '" +
                                (folder_ / "flight.mkv").string() + "' -c:v ffv1 -pix_fmt " +
                                format + " '" + clip.string() + "'";
    ASSERT_EQ(std::system(command.c_str()), 0);
    const auto [outside, all] = differing(scene_over(clip, 0, 6));
    EXPECT_EQ(outside, 0) << format;
    EXPECT_GT(all, 1000) << format;
  }
}

TEST_F(Untouched, InTheRealClips) {
  const char* shared = test_support::shared_folder();
  if (shared == nullptr) GTEST_SKIP() << "AIRTRUTH_SHARED is unset: the real clips are not here";
  const fs::path footage = fs::path(shared) / "footage";
  for (const char* clip :
       {"fixed-wing/cumulus_a4.mp4", "fixed-wing/overcast_b4.mp4", "gopro-karma/karma.mp4"}) {
    const auto [outside, all] = differing(scene_over(footage / clip, 20, 40));
    EXPECT_EQ(outside, 0) << clip;
    EXPECT_GT(all, 10000) << clip;
  }
}

}  // namespace
}  // namespace airtruth::pipeline
