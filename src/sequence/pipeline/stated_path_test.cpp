// SPDX-License-Identifier: Apache-2.0
// Intruders whose path is given by an encounter or by what is seen, in whole clips: virtual
// flights, whose camera is known exactly.
#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "foundation/base/error.h"
#include "sequence/demo/demo.h"
#include "sequence/pipeline/render.h"
#include "sequence/replay/finished.h"
#include "sequence/setup/from_scene.h"
#include "support/temporary_folder.h"

namespace airtruth::pipeline {
namespace {

constexpr int kPathWidth = 640;
constexpr int kPathHeight = 480;
constexpr int kPathFrames = 40;

class StatedPath : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    root_ = temporary_.emplace().path();
    synthetic::FlightOptions options;
    options.width = kPathWidth;
    options.height = kPathHeight;
    options.frame_count = kPathFrames;
    options.own_aircraft = false;
    flight_.emplace(options);
    demo::VirtualFlightOptions how;
    how.format = video::Format::kMkv;
    demo::write_flight(*flight_, root_ / "flight.mkv", how);
  }
  static void TearDownTestSuite() {
    flight_.reset();
    temporary_.reset();
  }

  // The camera of the scene flies as the virtual one; its attitude is the true one of frame 0.
  static scene::Scene scene_of(const std::string& name, const std::string& intruders) {
    const YawPitchRoll attitude = yaw_pitch_roll(flight_->camera(0).world_from_body);
    const std::string text = fmt::format(
        "name = '{}'\n[background]\nvideo = 'flight.mkv'\n[lens]\nvertical_fov_deg = 75\n"
        "[camera]\nposition_ned_m = [0, 0, -150]\nvelocity_ned_mps = [25, 0, 0]\n"
        "attitude_yaw_pitch_roll_deg = [{}, {}, {}]\n[output]\nvideo = 'mkv'\n[render]\nquality = "
        "1\n{}",
        name,
        attitude.yaw_deg,
        attitude.pitch_deg,
        attitude.roll_deg,
        intruders);
    return scene::parse_scene(text, root_ / "scene.toml");
  }

  static replay::Finished rendered(const scene::Scene& scene, const Warn& warn = {}) {
    Options options;
    options.use_cache = false;
    options.warn = warn;
    return replay::open_finished(render(scene, root_ / "out", options).folder);
  }

  // Where the true camera of a frame sees a point.
  static Pixel true_pixel(int frame, const Vector3& p_in_world) {
    const Rigid world_from_cam = flight_->camera(frame).world_from_body_rigid() *
                                 Rigid{cam_from_body().conjugate(), Vector3::Zero()};
    return *flight_->lens().pixel_from_cam(world_from_cam.inverse() * p_in_world);
  }

  static inline std::optional<test_support::TemporaryFolder> temporary_;
  static inline fs::path root_;
  static inline std::optional<synthetic::Flight> flight_;
};

const std::string kSeen =
    "[[intruder]]\naircraft = 'c172/news'\n"
    "[[intruder.seen]]\ntime_s = 0.2\npixel = [210, 160]\nrange_m = 160\n"
    "[[intruder.seen]]\ntime_s = 0.7\npixel = [320.5, 190]\nwidth_px = 60\n"
    "[[intruder.seen]]\ntime_s = 1.2\npixel = [460, 150]\nrange_m = 110\n";

// A round one: the middle of its box is where its reference point is seen.
const std::string kSeenBalloon =
    "[[distractor]]\nkind = 'balloon'\nsize_m = 1\n"
    "[[distractor.seen]]\ntime_s = 0.2\npixel = [210, 160]\nrange_m = 160\n"
    "[[distractor.seen]]\ntime_s = 0.7\npixel = [320.5, 190]\nrange_m = 130\n"
    "[[distractor.seen]]\ntime_s = 1.2\npixel = [460, 150]\nrange_m = 110\n";

TEST_F(StatedPath, TheTrueCameraSeesItWithinHalfAPixelOfWhatIsStated) {
  const scene::Scene scene = scene_of("seen", kSeen + kSeenBalloon);
  const replay::Finished finished = rendered(scene);
  double largest_px = 0;
  for (const scene::Seen& seen : scene.intruders[0].seen) {
    const int frame = static_cast<int>(std::lround(seen.time_s * 30));
    const annotation::Frame& truth = finished.truth.frames.at(static_cast<std::size_t>(frame));
    const annotation::Intruder& intruder = truth.intruders[0];
    const Box& box = *intruder.exact_box_px;
    EXPECT_NEAR(box.x + box.width / 2, seen.pixel.x(), 0.01) << frame;
    EXPECT_NEAR(box.y + box.height / 2, seen.pixel.y(), 0.01) << frame;
    const Pixel pixel = true_pixel(frame, vector_of(*truth.intruders[1].position_ned_m));
    largest_px = std::max(largest_px, (pixel - seen.pixel).norm());
    EXPECT_LT((pixel - seen.pixel).norm(), 0.5) << frame;
    if (seen.range_m) {
      EXPECT_NEAR(*intruder.range_m, *seen.range_m, 1e-6);
    }
    if (seen.width_px) {
      EXPECT_NEAR(intruder.exact_box_px->width, *seen.width_px, 0.02);
    }
    EXPECT_EQ(intruder.state, annotation::State::kVisible);
  }
  RecordProperty("largest_px", fmt::format("{:.3f}", largest_px));
  // The record has the path as found, and gives the same frames again.
  ASSERT_TRUE(finished.scene);
  EXPECT_TRUE(finished.scene->intruders[0].seen.empty());
  EXPECT_EQ(finished.scene->intruders[0].times_s.size(), 5u);
  EXPECT_EQ(replay::recompose(finished, 13, {}).faults, std::vector<std::string>{});
}

TEST_F(StatedPath, AMomentOutsideTheClipIsAnError) {
  std::string late = kSeen;
  late.replace(late.find("1.2"), 3, "9.5");
  try {
    rendered(scene_of("late", late));
    FAIL() << "expected an error";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what())
                  .find("time_s is 9.500, where the clip has no frame: the nearest is at 1.300 s"),
              std::string::npos)
        << error.what();
  }
}

TEST_F(StatedPath, AnEncounterIsWhereItWasSaidToBe) {
  const replay::Finished finished =
      rendered(scene_of("near",
                        "[[intruder]]\naircraft = 'c172/news'\n[intruder.encounter]\n"
                        "cpa_time_s = 1\ncpa_right_m = 30\ncpa_above_m = 10\ncourse_deg = 180\n"
                        "speed_mps = 50\n"));
  const annotation::Frame& frame = finished.truth.frames.at(30);
  const Vector3 offset =
      vector_of(*frame.intruders[0].position_ned_m) - vector_of(frame.camera_position_ned_m);
  EXPECT_NEAR(offset.x(), 0, 1e-6);
  EXPECT_NEAR(offset.y(), 30, 1e-6);
  EXPECT_NEAR(offset.z(), -10, 1e-6);
  EXPECT_EQ(replay::recompose(finished, 13, {}).faults, std::vector<std::string>{});
}

TEST_F(StatedPath, APathThatCannotBeFlownOrIsNeverSeenWarns) {
  std::vector<std::string> warnings;
  rendered(scene_of("warned",
                    "[[intruder]]\nid = 'fast'\naircraft = 'c172/news'\n[intruder.encounter]\n"
                    "cpa_time_s = 1\ncpa_right_m = 300\ncourse_deg = 0\nspeed_mps = 131\n"
                    "[[intruder]]\nid = 'behind'\naircraft = 'c172/news'\n[intruder.encounter]\n"
                    "cpa_time_s = -20\ncourse_deg = 180\nspeed_mps = 50\ncpa_right_m = 9\n"
                    "[[intruder]]\nid = 'returns'\naircraft = 'c172/news'\n[intruder.encounter]\n"
                    "cpa_time_s = 1.2\ncpa_right_m = 30\ncourse_deg = 90\nspeed_mps = 45\n"
                    "turn_rate_dps = 60\n"),
           [&](const std::string& text) { warnings.push_back(text); });
  const auto warned = [&](const std::string& words) {
    return std::any_of(warnings.begin(), warnings.end(), [&](const std::string& text) {
      return text.find(words) != std::string::npos;
    });
  };
  EXPECT_TRUE(
      warned("intruder 'fast': c172/news (light piston) cannot fly its path: at 0.00 s it "
             "flies 131.0 m/s, the fastest of its class 92 m/s"));
  EXPECT_TRUE(
      warned("intruder 'returns' comes nearer than at its cpa_time_s of 1.20 s: 55.4 m in place "
             "of 61.8 m, at 0.00 s"));
  EXPECT_FALSE(warned("intruder 'fast' comes nearer"));
  EXPECT_TRUE(warned("intruder 'behind' is never visible; it comes nearest to the view's edge at"));
}

}  // namespace
}  // namespace airtruth::pipeline
