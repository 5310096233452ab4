// SPDX-License-Identifier: Apache-2.0
#include "runners/association/associator.h"

#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <set>

#include <gtest/gtest.h>

#include "foundation/base/error.h"

namespace airtruth::association {
namespace {

constexpr double kRate = 30;
constexpr int kWidth = 1280;
constexpr int kHeight = 960;

detector::SequenceInput sequence() {
  return {"test", kWidth, kHeight, kRate, lens::pinhole_from_vertical_fov(50, {kWidth, kHeight})};
}

detector::FrameInput frame_at(std::int64_t index, const Quaternion& turn = Quaternion::Identity()) {
  detector::FrameInput frame;
  frame.index = index;
  frame.time_s = static_cast<double>(index) / kRate;
  if (index > 0) frame.turn = detector::CameraTurn{turn, 0.2};
  return frame;
}

results::Detection at(double x, double y, double score = 1, double size = 10) {
  return {{x - size / 2, y - size / 2, size, size}, score, "aircraft", {}};
}

using Tracks = std::vector<std::optional<std::int64_t>>;

// Feeds one list of detections a frame and returns the track of the first detection of each frame;
// empty also where there is none.
Tracks tracks_of_first(Associator& associator,
                       const std::vector<std::vector<results::Detection>>& frames) {
  Tracks tracks;
  associator.begin(sequence());
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const auto found = associator.step(frame_at(static_cast<std::int64_t>(i)), frames[i]);
    tracks.push_back(found.empty() ? std::nullopt : found[0].track);
  }
  return tracks;
}

constexpr auto kNone = std::nullopt;

TEST(Declaration, TheExampleOfTheHeader) {
  Associator associator({.declare_m = 3, .declare_n = 5});
  EXPECT_EQ(tracks_of_first(associator,
                            {{at(100, 100)}, {at(101, 100)}, {}, {at(103, 100)}, {at(104, 100)}}),
            (Tracks{kNone, kNone, kNone, 1, 1}));
}

TEST(Declaration, ByHand) {
  const std::vector<results::Detection> seen = {at(100, 100)};
  const std::vector<results::Detection> none;
  Associator once({.declare_m = 1, .declare_n = 1});
  EXPECT_EQ(tracks_of_first(once, {seen, seen}), (Tracks{1, 1}));
  Associator two_of_two({.declare_m = 2, .declare_n = 2});
  EXPECT_EQ(tracks_of_first(two_of_two, {seen, none, seen, seen, seen}),
            (Tracks{kNone, kNone, kNone, 1, 1}));
  // 3 of 4 from the first detection on: the second miss ends the first try.
  Associator three_of_four({.declare_m = 3, .declare_n = 4});
  EXPECT_EQ(tracks_of_first(three_of_four, {seen, none, none, seen, seen, none, seen}),
            (Tracks{kNone, kNone, kNone, kNone, kNone, kNone, 1}));
}

TEST(Declaration, WeakDetectionsKeepATrackAndNeverBeginOne) {
  Associator associator({.declare_m = 2, .declare_n = 3, .confident_score = 0.5});
  const auto strong = std::vector{at(100, 100, 0.9)};
  const auto weak = std::vector{at(100, 100, 0.2)};
  EXPECT_EQ(tracks_of_first(associator, {weak, weak, weak, strong, strong, weak, weak}),
            (Tracks{kNone, kNone, kNone, kNone, 1, 1, 1}));
}

TEST(Declaration, AMissedTrackIsTakenUpUntilItsTimeIsOver) {
  for (const auto& [missed, expected] : {std::pair{15, 1}, {40, 2}}) {
    Associator associator({.declare_m = 2, .declare_n = 2});
    std::vector<std::vector<results::Detection>> frames(5, {at(200, 200)});
    frames.insert(frames.end(), static_cast<std::size_t>(missed), {});
    frames.insert(frames.end(), 3, {at(200, 200)});
    EXPECT_EQ(tracks_of_first(associator, frames).back(), expected) << missed;
  }
}

TEST(Shots, ANewShotEndsAllTracks) {
  Associator associator({.declare_m = 1, .declare_n = 1});
  associator.begin(sequence());
  EXPECT_EQ(associator.step(frame_at(0), {at(100, 100)})[0].track, 1);
  detector::FrameInput cut = frame_at(1);
  cut.begins_shot = true;
  cut.turn.reset();
  EXPECT_EQ(associator.step(cut, {at(100, 100)})[0].track, 2);
  associator.begin(sequence());
  EXPECT_EQ(associator.step(frame_at(0), {at(100, 100)})[0].track, 1);
}

// 0.3 rad/s for 1/30 s are 0.01 rad or 10 px: a jump of 12 px is within the gate, one of 100 px is
// not.
TEST(Shots, AnUnknownTurnWidensTheGate) {
  for (const auto& [jump_px, expected] : {std::pair{12, true}, {100, false}}) {
    Associator associator({.declare_m = 3, .declare_n = 3});
    associator.begin(sequence());
    std::vector<results::Detection> found;
    for (int i = 0; i < 20; ++i) {
      detector::FrameInput frame = frame_at(i);
      if (i == 19) frame.turn.reset();
      found = associator.step(frame, {at(i == 19 ? 300 + jump_px : 300, 300)});
    }
    EXPECT_EQ(found[0].track.has_value(), expected) << jump_px;
  }
}

TEST(Categories, ATrackHoldsOneCategory) {
  Associator associator({.declare_m = 1, .declare_n = 1});
  associator.begin(sequence());
  associator.step(frame_at(0), {at(100, 100)});
  results::Detection bird = at(100, 100);
  bird.category = "bird";
  EXPECT_EQ(associator.step(frame_at(1), {bird})[0].track, 2);
}

// Targets of constant angular rate before a camera that turns: their rays in a world that is at
// rest, seen through the true turns. The measured turns have errors.
class Scene {
 public:
  Scene(unsigned seed, double turn_error_px, double clutter_per_frame, double detection_share)
      : random_(seed),
        lens_(sequence().lens),
        turn_error_px_(turn_error_px),
        clutter_(clutter_per_frame),
        share_(detection_share) {}

  void add(
      double azimuth, double elevation, double azimuth_rate, double elevation_rate, double px) {
    targets_.push_back({azimuth, elevation, azimuth_rate, elevation_rate, px});
  }

  // For each target the tracks that its detections had, with their counts; and the number of
  // clutter detections that have the track of a target's majority.
  struct Result {
    std::vector<std::map<std::int64_t, int>> tracks;
    std::vector<int> detections;
    std::set<std::int64_t> declared;
  };
  Result run(Associator& associator, int frames, bool with_turn = true) {
    Result result;
    result.tracks.resize(targets_.size());
    result.detections.resize(targets_.size());
    associator.begin(sequence());
    Quaternion cam_from_world = Quaternion::Identity();
    for (int i = 0; i < frames; ++i) {
      const double t = i / kRate;
      // It sways, and shakes by 10 px from frame to frame.
      const Quaternion next =
          turned(10) * Quaternion(Eigen::AngleAxisd(0.15 * std::sin(1.1 * t), Vector3::UnitY())) *
          Quaternion(Eigen::AngleAxisd(0.08 * std::sin(2.3 * t), Vector3::UnitX())) *
          Quaternion(Eigen::AngleAxisd(0.2 * std::sin(0.7 * t), Vector3::UnitZ()));
      detector::FrameInput frame =
          frame_at(i, turned(turn_error_px_) * (next * cam_from_world.conjugate()));
      if (frame.turn) frame.turn->error_px = turn_error_px_;
      if (frame.turn && !with_turn) frame.turn->this_from_previous = Quaternion::Identity();
      cam_from_world = next;
      const auto [detections, target_of] = seen(cam_from_world, t);
      const auto tracked = associator.step(frame, detections);
      for (std::size_t d = 0; d < tracked.size(); ++d) {
        if (tracked[d].track) result.declared.insert(*tracked[d].track);
        if (!target_of[d]) continue;
        ++result.detections[*target_of[d]];
        if (tracked[d].track) ++result.tracks[*target_of[d]][*tracked[d].track];
      }
    }
    return result;
  }

 private:
  struct Target {
    double azimuth, elevation, azimuth_rate, elevation_rate, px;
  };

  double normal() { return normal_(random_); }
  double uniform() { return uniform_(random_); }

  Quaternion turned(double px) {
    const Vector3 turn = px / focal() * Vector3(normal(), normal(), 0);
    return turn.norm() > 0 ? Quaternion(Eigen::AngleAxisd(turn.norm(), turn.normalized()))
                           : Quaternion::Identity();
  }
  static double focal() { return kHeight / 2.0 / std::tan(radians(25)); }

  std::pair<std::vector<results::Detection>, std::vector<std::optional<std::size_t>>> seen(
      const Quaternion& cam_from_world, double t) {
    std::vector<results::Detection> detections;
    std::vector<std::optional<std::size_t>> target_of;
    for (std::size_t i = 0; i < targets_.size(); ++i) {
      const Target& target = targets_[i];
      const double azimuth = target.azimuth + target.azimuth_rate * t;
      const double elevation = target.elevation + target.elevation_rate * t;
      const Vector3 ray(std::sin(azimuth) * std::cos(elevation),
                        -std::sin(elevation),
                        std::cos(azimuth) * std::cos(elevation));
      const auto pixel = lens_.pixel_from_cam(cam_from_world * ray);
      if (!pixel || uniform() > share_) continue;
      const double size = target.px * std::exp(0.1 * normal());
      detections.push_back(at(pixel->x() + 0.5 * normal(), pixel->y() + 0.5 * normal(), 1, size));
      target_of.emplace_back(i);
    }
    const int clutter = std::poisson_distribution<int>(clutter_)(random_);
    for (int i = 0; i < clutter; ++i) {
      detections.push_back(at(uniform() * kWidth, uniform() * kHeight, 1, 4 + 20 * uniform()));
      target_of.emplace_back();
    }
    return {detections, target_of};
  }

  std::mt19937 random_;
  std::normal_distribution<double> normal_;
  std::uniform_real_distribution<double> uniform_{0, 1};
  lens::Lens lens_;
  double turn_error_px_;
  double clutter_;
  double share_;
  std::vector<Target> targets_;
};

// The share of a target's detections that its commonest track has.
double share_of_commonest(const Scene::Result& result, std::size_t target) {
  int most = 0;
  for (const auto& [track, count] : result.tracks[target]) most = std::max(most, count);
  return static_cast<double>(most) / result.detections[target];
}

TEST(Tracks, KeepTheirNumbersThroughTurnsClutterAndMisses) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    Scene scene(seed, 0.3, 20, 0.85);
    scene.add(-0.2, 0.05, 0.06, 0.01, 12);
    scene.add(0.1, -0.1, -0.03, 0.03, 7);
    scene.add(0.25, 0.1, 0.0, 0.0, 30);
    Associator associator({.declare_m = 4, .declare_n = 6});
    const auto result = scene.run(associator, 150);
    std::set<std::int64_t> numbers;
    for (std::size_t target = 0; target < 3; ++target) {
      EXPECT_GT(share_of_commonest(result, target), 0.9) << "seed " << seed << " target " << target;
      for (const auto& [track, count] : result.tracks[target]) {
        if (count > result.detections[target] / 2) numbers.insert(track);
      }
    }
    EXPECT_EQ(numbers.size(), 3u);
    // Clutter of 20 a frame in 1.2 million pixels seldom lines up four times in six frames.
    EXPECT_LT(result.declared.size(), 6u) << seed;
  }
}

TEST(Tracks, NeedTheCamerasTurn) {
  const auto numbers = [](bool with_turn) {
    Scene scene(1, 0.3, 0, 1);
    scene.add(-0.1, 0.05, 0.02, 0.0, 12);
    Associator associator({.declare_m = 4, .declare_n = 6});
    return scene.run(associator, 100, with_turn).declared.size();
  };
  EXPECT_EQ(numbers(true), 1u);
  EXPECT_NE(numbers(false), 1u);
}

TEST(Tracks, CrossWithoutExchangingTheirNumbers) {
  for (unsigned seed = 1; seed <= 8; ++seed) {
    Scene scene(seed, 0.1, 2, 0.95);
    // They meet at azimuth 0 after 2.5 s, from opposite sides, and pass within a pixel.
    scene.add(-0.1, 0.0205, 0.04, 0.0, 10);
    scene.add(0.1, 0.02, -0.04, 0.0, 10);
    Associator associator({.declare_m = 3, .declare_n = 5});
    const auto result = scene.run(associator, 150);
    EXPECT_GT(share_of_commonest(result, 0), 0.9) << seed;
    EXPECT_GT(share_of_commonest(result, 1), 0.9) << seed;
  }
}

TEST(Tracks, ALargerErrorOfTheTurnWidensTheGate) {
  // A detection jumps by 12 px for one frame, as if the camera's turn were wrong.
  for (const auto& [error_px, expected] : {std::pair{0.1, false}, {8.0, true}}) {
    Associator associator({.declare_m = 3, .declare_n = 3});
    associator.begin(sequence());
    std::vector<results::Detection> found;
    for (int i = 0; i < 20; ++i) {
      detector::FrameInput frame = frame_at(i);
      if (frame.turn) frame.turn->error_px = i == 19 ? error_px : 0.1;
      found = associator.step(frame, {at(i == 19 ? 312 : 300, 300)});
    }
    EXPECT_EQ(found[0].track.has_value(), expected) << error_px;
  }
}

TEST(Options, OutOfRangeIsAnError) {
  EXPECT_THROW(Associator({.declare_m = 4, .declare_n = 3}), Error);
  EXPECT_THROW(Associator({.declare_m = 0, .declare_n = 3}), Error);
  EXPECT_THROW(Associator({.confident_score = std::numeric_limits<double>::quiet_NaN()}), Error);
}

}  // namespace
}  // namespace airtruth::association
