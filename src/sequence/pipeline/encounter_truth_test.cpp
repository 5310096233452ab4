// SPDX-License-Identifier: Apache-2.0
// The truth of encounters in whole sequences, computed again from the positions that truth.jsonl
// states and from the paths, in another way.
#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "sequence/demo/demo.h"
#include "sequence/pipeline/encounter_record.h"
#include "sequence/pipeline/render.h"
#include "sequence/replay/finished.h"
#include "sequence/setup/from_scene.h"
#include "sequence/setup/world.h"
#include "support/temporary_folder.h"

namespace airtruth::pipeline {
namespace {

constexpr int kEncounterFrames = 60;
constexpr double kRate_hz = 10;

const std::string kScene =
    "name = 'met'\n[background]\nvideo = 'flight.mkv'\n[lens]\nvertical_fov_deg = 75\n"
    "[camera]\nposition_ned_m = [0, 0, -150]\nvelocity_ned_mps = [30, 5, -1]\n"
    "attitude_yaw_pitch_roll_deg = [0, 0, 0]\n"
    "[motion]\nmodel = 'none'\n[output]\nvideo = 'mkv'\n[render]\nquality = 1\n"
    "[truth]\nvolumes = ['f3442', 'nmac']\n[[truth.volume]]\nname = 'own'\nhorizontal_m = 40\n"
    "vertical_m = 20\n"
    "[[intruder]]\nid = 'near'\naircraft = 'c172/news'\n[intruder.encounter]\ncpa_time_s = 4.25\n"
    "cpa_right_m = 25\ncpa_above_m = 8\ncourse_deg = 180\nspeed_mps = 50\nclimb_mps = -3\n"
    "[[intruder]]\nid = 'turns'\naircraft = 'c172/news'\n[intruder.encounter]\ncpa_time_s = 3\n"
    "cpa_right_m = 60\ncourse_deg = 120\nspeed_mps = 45\nturn_rate_dps = 4\n";

class EncounterTruth : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    root_ = temporary_.emplace().path();
    synthetic::FlightOptions options;
    options.width = 160;
    options.height = 120;
    options.frame_count = kEncounterFrames;
    options.frame_rate_hz = kRate_hz;
    options.own_aircraft = false;
    demo::VirtualFlightOptions how;
    how.format = video::Format::kMkv;
    demo::write_flight(synthetic::Flight(options), root_ / "flight.mkv", how);
    Options render_options;
    render_options.use_cache = false;
    scene_ = scene::parse_scene(kScene, root_ / "scene.toml");
    finished_ = replay::open_finished(render(*scene_, root_ / "out", render_options).folder);
    record_ = nlohmann::json::parse(read_file(finished_->folder / "sequence.json"));
  }
  static void TearDownTestSuite() {
    scene_.reset();
    finished_.reset();
    temporary_.reset();
  }

  static inline std::optional<test_support::TemporaryFolder> temporary_;
  static inline fs::path root_;
  static inline std::optional<scene::Scene> scene_;
  static inline std::optional<replay::Finished> finished_;
  static inline nlohmann::json record_;
};

// What the positions of three neighbouring frames say, by central differences.
struct Observed {
  Vector3 offset, velocity, own_velocity;
  double closing_mps = 0, bearing_deg = 0, bearing_rate_dps = 0, sight_rate_dps = 0;
};

double bearing_of(const Vector3& offset) { return degrees(std::atan2(offset.y(), offset.x())); }

Observed observed(const std::vector<annotation::Frame>& frames, std::size_t k, std::size_t i) {
  const auto offset = [&](std::size_t n) -> Vector3 {
    return vector_of(*frames[n].intruders[i].position_ned_m) -
           vector_of(frames[n].camera_position_ned_m);
  };
  const double span_s = frames[k + 1].time_s - frames[k - 1].time_s;
  Observed o;
  o.offset = offset(k);
  o.velocity = (offset(k + 1) - offset(k - 1)) / span_s;
  o.own_velocity = (vector_of(frames[k + 1].camera_position_ned_m) -
                    vector_of(frames[k - 1].camera_position_ned_m)) /
                   span_s;
  o.closing_mps = (offset(k - 1).norm() - offset(k + 1).norm()) / span_s;
  o.bearing_deg = bearing_of(o.offset);
  o.bearing_rate_dps =
      std::remainder(bearing_of(offset(k + 1)) - bearing_of(offset(k - 1)), 360) / span_s;
  const double cosine = offset(k + 1).normalized().dot(offset(k - 1).normalized());
  o.sight_rate_dps = degrees(std::acos(std::clamp(cosine, -1.0, 1.0))) / span_s;
  return o;
}

TEST_F(EncounterTruth, EveryFrameIsWhatItsNeighboursPositionsSay) {
  const auto& frames = finished_->truth.frames;
  ASSERT_EQ(frames.size(), std::size_t{kEncounterFrames});
  int compared = 0;
  for (std::size_t k = 1; k + 1 < frames.size(); ++k) {
    for (std::size_t i = 0; i < 2; ++i) {
      SCOPED_TRACE(std::to_string(k) + " " + frames[k].intruders[i].id);
      const Observed o = observed(frames, k, i);
      ASSERT_TRUE(frames[k].intruders[i].encounter);
      const annotation::EncounterTruth& m = *frames[k].intruders[i].encounter;
      EXPECT_NEAR(m.horizontal_m, std::hypot(o.offset.x(), o.offset.y()), 1e-9);
      EXPECT_NEAR(m.above_m, -o.offset.z(), 1e-9);
      // Differences over 0.2 s are off by the third derivatives, which are large close by.
      if (o.offset.norm() < 150) continue;
      ++compared;
      EXPECT_NEAR(*m.closing_speed_mps, o.closing_mps, 0.02 * o.velocity.norm());
      EXPECT_NEAR(std::remainder(*m.bearing_deg - o.bearing_deg, 360), 0, 1e-9);
      EXPECT_NEAR(*m.bearing_rate_dps, o.bearing_rate_dps, 0.1);
      EXPECT_NEAR(*m.line_of_sight_rate_dps, o.sight_rate_dps, 0.1);
      EXPECT_NEAR(
          std::remainder(*m.relative_bearing_deg - o.bearing_deg + bearing_of(o.own_velocity), 360),
          0,
          1e-6);
      // The least horizontal distance, by walking along the observed velocity.
      double hmd_m = 1e9;
      for (int step = 0; step <= 18'000; ++step) {
        const Vector3 then = o.offset + 0.01 * step * o.velocity;
        hmd_m = std::min(hmd_m, std::hypot(then.x(), then.y()));
      }
      EXPECT_NEAR(m.hmd_m, hmd_m, 3);  // the observed velocity of a turn is a chord's
    }
  }
  EXPECT_GT(compared, 40);
}

// The straight intruder's times to a violation count down to when the record says that it begins.
TEST_F(EncounterTruth, TimesToAViolationCountDownToTheRecord) {
  const auto& violations = record_.at("encounters").at(0).at("violations");
  ASSERT_EQ(violations.size(), 3u);
  for (std::size_t v = 0; v < 3; ++v) {
    const double begin_s = violations[v].at("begin_s");
    const double end_s = violations[v].at("end_s");
    for (const annotation::Frame& frame : finished_->truth.frames) {
      const annotation::VolumeTruth& volume = frame.intruders[0].encounter->volumes.at(v);
      EXPECT_EQ(volume.name, violations[v].at("volume").get<std::string>());
      EXPECT_EQ(volume.inside, frame.time_s >= begin_s && frame.time_s <= end_s);
      ASSERT_EQ(volume.to_violation_s.has_value(), frame.time_s <= end_s);
      if (volume.to_violation_s) {
        EXPECT_NEAR(frame.time_s + *volume.to_violation_s, std::max(frame.time_s, begin_s), 1e-5);
      }
    }
  }
}

TEST_F(EncounterTruth, TheRecordHasTheClosestApproachOfTheWholePaths) {
  const auto own = setup::camera_path(scene_->camera);
  for (std::size_t i = 0; i < 2; ++i) {
    const auto path = setup::path_of(scene_->intruders[i], own);
    double least_m = 1e9;
    double at_s = 0;
    for (double t = 0; t < kEncounterFrames / kRate_hz + 180; t += 1e-3) {
      const double distance_m =
          (path.at(t)->position_in_world - own.at(t)->position_in_world).norm();
      if (distance_m >= least_m) continue;
      least_m = distance_m;
      at_s = t;
    }
    const auto& closest = record_.at("encounters").at(i).at("closest_approach");
    EXPECT_NEAR(closest.at("distance_m"), least_m, 1e-3);
    EXPECT_NEAR(closest.at("time_s"), at_s, 1e-3);
  }
  // The straight one's is where the scene puts it, between two frames.
  const auto& near = record_.at("encounters").at(0);
  EXPECT_NEAR(near.at("closest_approach").at("time_s"), 4.25, 1e-6);
  EXPECT_NEAR(near.at("closest_approach").at("right_m"), 25, 1e-6);
  EXPECT_NEAR(near.at("closest_approach").at("above_m"), 8, 1e-6);
  EXPECT_EQ(near.at("meeting"), "head-on");
  EXPECT_EQ(near.at("vertical_motion"), "descending");
}

TEST_F(EncounterTruth, TheRecordSaysWhenItIsFirstSeen) {
  const auto& record = record_.at("encounters").at(0);
  const auto& first = record.at("first_seen");
  const auto& frames = finished_->truth.frames;
  const auto seen = std::find_if(frames.begin(), frames.end(), [](const annotation::Frame& frame) {
    return frame.intruders[0].state == annotation::State::kVisible;
  });
  ASSERT_NE(seen, frames.end());
  EXPECT_EQ(first.at("frame"), seen->frame);
  EXPECT_EQ(first.at("range_m"), *seen->intruders[0].range_m);
  EXPECT_EQ(first.at("width_px"), seen->intruders[0].exact_box_px->width);
  EXPECT_NEAR(first.at("to_closest_approach_s"), 4.25 - seen->time_s, 1e-6);
  // It descends from above: over the horizon at first.
  EXPECT_EQ(first.at("horizon"), "above");
}

// A 738 at 600 m is 12.5 m high and, banked by 90 degrees, 35 m. The horizon of a camera at 10 m is
// a metre lower there. The box of the picture, here of a rolled camera, says nothing of that
// height.
TEST(Encounters, TheHorizonIsOnAnAircraftByItsHeightInTheWorld) {
  const auto horizon = [](double up_m, double roll_deg) {
    scene::Scene scene;
    scene.lens.vertical_fov_deg = 60;
    scene.camera.position_ned_m = {0, 0, -10};
    scene::Intruder& intruder = scene.intruders.emplace_back();
    intruder.aircraft = "738/738-Ryanair";
    intruder.waypoints_ned_m = {{600, 0, -up_m}, {800, 0, -up_m}};
    intruder.speed_mps = 100;
    intruder.roll_deg = roll_deg;
    const setup::World world = setup::load_world(scene, {320, 240}, {});
    const FirstSeen seen{0, 0, 600, {150, 100, 5, 12}};
    return encounter_records(world, {seen}, 1).at(0).horizon_when_first_seen;
  };
  EXPECT_EQ(horizon(24, 0), passage::AgainstHorizon::kAbove);
  EXPECT_EQ(horizon(24, 90), passage::AgainstHorizon::kOn);
  EXPECT_EQ(horizon(5, 0), passage::AgainstHorizon::kOn);
}

TEST_F(EncounterTruth, TheRecordIsReadAsItWasWritten) {
  ASSERT_EQ(finished_->encounters.size(), 2u);
  EXPECT_EQ(nlohmann::json(json_of(finished_->encounters)), record_.at("encounters"));
}

TEST_F(EncounterTruth, ARecordThatNamesNoMeetingIsAnError) {
  const fs::path folder = root_ / "spoilt";
  fs::copy(finished_->folder, folder);
  nlohmann::json record = record_;
  record["encounters"][0]["meeting"] = "sideways";
  write_file(folder / "sequence.json", record.dump());
  try {
    replay::open_finished(folder);
    ADD_FAILURE() << "opened";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what())
                  .find("encounters[0].meeting is \"sideways\"; expected one "
                        "of head-on, crossing from left"),
              std::string::npos)
        << error.what();
  }
}

TEST_F(EncounterTruth, ComputedAgainItIsTheSame) {
  EXPECT_EQ(replay::recompose(*finished_, 7, {}).faults, std::vector<std::string>{});
}

TEST_F(EncounterTruth, AnUnknownVolumeIsAnError) {
  std::string text = kScene;
  text.replace(text.find("'nmac'"), 6, "'nmca'");
  try {
    render(scene::parse_scene(text, root_ / "scene.toml"), root_ / "out2", {});
    FAIL() << "expected an error";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what())
                  .find("scene.toml:16:1: [truth] volumes has 'nmca', which is "
                        "unknown; did you mean 'nmac'?"),
              std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace airtruth::pipeline
