// SPDX-License-Identifier: Apache-2.0
#include "camera/motion/motion.h"

#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "camera/motion/estimator.h"
#include "camera/motion/shake.h"
#include "foundation/base/error.h"
#include "foundation/base/median.h"
#include "foundation/base/seed.h"
#include "support/temporary_folder.h"

namespace airtruth::motion {
namespace {

constexpr int kWidth = 480;
constexpr int kHeight = 360;

// A large textured wall, of which each frame sees a part through a known homography.
cv::Mat wall() {
  cv::Mat sum(900, 1200, CV_32F, cv::Scalar(0));
  Random random = Seed(11).stream("wall");
  for (int octave = 0; octave < 6; ++octave) {
    const int cells = 10 << octave;
    cv::Mat noise(cells, cells, CV_32F);
    for (int i = 0; i < cells * cells; ++i)
      noise.at<float>(i / cells, i % cells) = static_cast<float>(random.normal());
    cv::Mat large;
    cv::resize(noise, large, sum.size(), 0, 0, cv::INTER_CUBIC);
    sum += large * std::pow(0.62, octave);
  }
  cv::Mat grey;
  sum.convertTo(grey, CV_8U, 34, 118);
  return grey;
}

// The position of frame k: drift, shake, roll and a little perspective, in OpenCV's pixels.
Homography frame_from_wall(double k) {
  Homography h = Homography::Identity();
  const double a = 0.01 * std::sin(0.3 * k);
  h << std::cos(a), -std::sin(a), -340 - 0.8 * k + 5 * std::sin(1.1 * k), std::sin(a), std::cos(a),
      -260 + 4 * std::cos(1.7 * k), 1.5e-5 * std::sin(0.2 * k), 1e-5 * std::cos(0.37 * k), 1;
  return h;
}

image::Picture frame(const cv::Mat& texture, double k, double noise = 1.5) {
  const Homography h = frame_from_wall(k);
  cv::Mat seen;
  const cv::Matx33d m(
      h(0, 0), h(0, 1), h(0, 2), h(1, 0), h(1, 1), h(1, 2), h(2, 0), h(2, 1), h(2, 2));
  cv::warpPerspective(texture, seen, m, {kWidth, kHeight}, cv::INTER_CUBIC);
  image::Picture picture = image::make_picture(kWidth, kHeight, {image::Chroma::kNone});
  Random random = Seed(5).stream("noise", static_cast<std::uint64_t>(k * 7));
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      picture.planes[0].row(y)[x] = static_cast<std::uint8_t>(
          std::clamp(seen.at<unsigned char>(y, x) + noise * random.normal(), 0.0, 255.0));
  return picture;
}

Homography ours(const Homography& cv) {
  Homography t = Homography::Identity();
  t(0, 2) = t(1, 2) = 0.5;
  return t * cv * t.inverse();
}

double corner_error(const Homography& a, const Homography& b) {
  double sum = 0;
  for (const Pixel& p : {Pixel(0, 0), Pixel(kWidth, 0), Pixel(0, kHeight), Pixel(kWidth, kHeight)})
    sum += (apply(a, p) - apply(b, p)).norm();
  return sum / 4;
}

image::Picture blank() {
  image::Picture picture = image::make_picture(kWidth, kHeight, {image::Chroma::kNone});
  for (int y = 0; y < kHeight; ++y)
    std::fill_n(picture.planes[0].row(y), kWidth, std::uint8_t{120});
  return picture;
}

TEST(Estimator, FollowsAKnownMotionBesideMovingClutter) {
  const cv::Mat texture = wall();
  Estimator estimator(kWidth, kHeight);
  Random random(9);
  std::vector<double> step_errors;
  Homography last = Homography::Identity();
  const Homography first = ours(frame_from_wall(0));
  double final_error = 0;
  for (int k = 0; k < 60; ++k) {
    image::Picture picture = frame(texture, k);
    // A fifth of the picture is a patch of another wall that drifts by itself.
    const image::Picture other = frame(texture, 200 + 3.0 * k, 0);
    for (int y = 40; y < 200; ++y)
      std::copy_n(other.planes[0].row(y) + 100, 216, picture.planes[0].row(y) + 40);
    const FrameMotion motion = estimator.next(picture, k / 30.0);
    ASSERT_EQ(motion.state, k == 0 ? State::kReference : State::kMeasured) << k;
    const Homography truth = ours(frame_from_wall(k)) * first.inverse();
    if (k > 0) {
      const Homography measured_step = motion.frame_from_reference * last.inverse();
      const Homography true_step =
          ours(frame_from_wall(k)) * ours(frame_from_wall(k - 1)).inverse();
      step_errors.push_back(corner_error(measured_step, true_step));
    }
    last = motion.frame_from_reference;
    final_error = corner_error(motion.frame_from_reference, truth);
  }
  const double median_px = median(step_errors);
  RecordProperty("median_step_error_px", std::to_string(median_px));
  EXPECT_LT(median_px, 0.3);
  EXPECT_LT(final_error, 2.0);
}

TEST(Estimator, SaysWhenItDoesNotKnow) {
  const cv::Mat texture = wall();
  Estimator estimator(kWidth, kHeight);
  for (int k = 0; k < 5; ++k) estimator.next(frame(texture, k), k / 30.0);
  const FrameMotion before = estimator.next(frame(texture, 5), 5 / 30.0);
  const FrameMotion bridged = estimator.next(blank(), 6 / 30.0);
  EXPECT_EQ(bridged.state, State::kBridged);
  EXPECT_EQ(bridged.inliers, 0);
  EXPECT_TRUE(bridged.frame_from_reference.isApprox(
      before.frame_from_reference));  // the motion continues; it is not the identity
  EXPECT_FALSE(bridged.frame_from_reference.isIdentity(1e-3));
  // The frame after the gap is linked to the frames before it.
  const FrameMotion after = estimator.next(frame(texture, 7), 7 / 30.0);
  EXPECT_EQ(after.state, State::kMeasured);
  EXPECT_LT(corner_error(after.frame_from_reference,
                         ours(frame_from_wall(7)) * ours(frame_from_wall(0)).inverse()),
            1.0);
  EXPECT_EQ(estimator.next(frame(texture, 8), 8 / 30.0, true).state, State::kBridged);  // damaged
}

TEST(Estimator, FlagsACut) {
  const cv::Mat texture = wall();
  cv::Mat other;
  cv::flip(texture, other, -1);
  cv::bitwise_not(other, other);
  Estimator estimator(kWidth, kHeight);
  for (int k = 0; k < 4; ++k) estimator.next(frame(texture, k), k / 30.0);
  EXPECT_EQ(estimator.next(frame(other, 4), 4 / 30.0).state, State::kCut);
  EXPECT_EQ(estimator.next(frame(other, 5), 5 / 30.0).state, State::kMeasured);
}

// The loss of corners would reveal a cut, but a picture of sky alone has no corners.
TEST(Estimator, ACutIsFlaggedWhereItIsSaidAndNothingIsFollowed) {
  Estimator estimator(kWidth, kHeight);
  for (int k = 0; k < 4; ++k) estimator.next(blank(), k / 30.0);
  EXPECT_EQ(estimator.next(blank(), 4 / 30.0).state, State::kBridged);
  EXPECT_EQ(estimator.next(blank(), 5 / 30.0, false, true).state, State::kCut);
  EXPECT_EQ(estimator.next(blank(), 6 / 30.0).state, State::kBridged);
}

// A frame that follows one with too few corners to track is no cut, and continues nothing.
TEST(Estimator, SaysWhereItsRotationBeginsAnew) {
  Estimator estimator(lens::pinhole_from_vertical_fov(60, {kWidth, kHeight}), {});
  EXPECT_FALSE(estimator.next(blank(), 0).begins_anew);
  const FrameMotion next = estimator.next(blank(), 1 / 30.0);
  EXPECT_EQ(next.state, State::kBridged);
  EXPECT_TRUE(next.begins_anew);
  EXPECT_FALSE(estimator.next(blank(), 2 / 30.0, true).begins_anew);  // damaged: passed over
}

// A bright object that suddenly covers a third of the view changes the picture as a cut does, while
// the rest of the picture continues.
TEST(Estimator, WhereMostCornersAreFollowedThereIsNoCut) {
  const cv::Mat texture = wall();
  Estimator estimator(kWidth, kHeight);
  for (int k = 0; k < 4; ++k) estimator.next(frame(texture, k), k / 30.0);
  image::Picture covered = frame(texture, 4);
  for (int y = 0; y < kHeight; ++y)
    std::fill_n(covered.planes[0].row(y), kWidth / 3, std::uint8_t{230});
  const FrameMotion after = estimator.next(covered, 4 / 30.0, false, true);
  EXPECT_EQ(after.state, State::kMeasured);
  EXPECT_LT(corner_error(after.frame_from_reference,
                         ours(frame_from_wall(4)) * ours(frame_from_wall(0)).inverse()),
            1.5);
}

// Two shots, each with its own shake and drift: smoothing both at once equals smoothing each alone.
TEST(Smoothed, DoesNotRunAcrossACut) {
  const cv::Mat texture = wall();
  cv::Mat other;
  cv::flip(texture, other, 0);
  Options options;
  options.smoothing_s = 0.3;
  constexpr int kShot = 20;
  Estimator both(kWidth, kHeight), second(kWidth, kHeight);
  std::vector<FrameMotion> spliced, alone;
  for (int k = 0; k < 2 * kShot; ++k) {
    const double time_s = k / 30.0;
    const image::Picture picture = frame(k < kShot ? texture : other, k);
    spliced.push_back(both.next(picture, time_s, false, k == kShot));
    if (k >= kShot) alone.push_back(second.next(picture, time_s));
  }
  ASSERT_EQ(spliced[kShot].state, State::kCut);
  const auto steady = smoothed(spliced, options), steady_alone = smoothed(alone, options);
  for (int k = 0; k < kShot; ++k) {
    const auto i = static_cast<std::size_t>(k);
    EXPECT_LT(
        corner_error(steady[i + kShot].frame_from_reference, steady_alone[i].frame_from_reference),
        0.05)
        << k;
  }
}

TEST(Estimator, IgnoresTheOwnAircraft) {
  const cv::Mat texture = wall();
  image::Mask mask{kWidth, kHeight, std::vector<unsigned char>(kWidth * kHeight, 255)};
  const image::Picture own = frame(texture, 300, 0);  // stands still in every frame
  const int top = kHeight * 55 / 100;
  for (int y = top; y < kHeight; ++y)
    std::fill_n(mask.free.begin() + y * kWidth, kWidth, static_cast<unsigned char>(0));
  Estimator estimator(kWidth, kHeight, &mask);
  FrameMotion motion;
  for (int k = 0; k < 20; ++k) {
    image::Picture picture = frame(texture, k);
    for (int y = top; y < kHeight; ++y)
      std::copy_n(own.planes[0].row(y), kWidth, picture.planes[0].row(y));
    motion = estimator.next(picture, k / 30.0);
  }
  EXPECT_EQ(motion.state, State::kMeasured);
  EXPECT_LT(corner_error(motion.frame_from_reference,
                         ours(frame_from_wall(19)) * ours(frame_from_wall(0)).inverse()),
            2.0);
}

std::string csv_of(const std::vector<FrameMotion>& motion) {
  std::string text;
  write_csv([&](std::string_view line) { text += line; }, motion);
  return text;
}

TEST(Estimator, TwoRunsAgreeToTheBit) {
  const cv::Mat texture = wall();
  std::vector<std::string> runs;
  for (int threads : {1, 2}) {
    cv::setNumThreads(threads);
    Estimator estimator(kWidth, kHeight);
    std::vector<FrameMotion> all;
    for (int k = 0; k < 8; ++k) all.push_back(estimator.next(frame(texture, k), k / 30.0));
    runs.push_back(csv_of(all));
  }
  cv::setNumThreads(-1);
  EXPECT_EQ(runs[0], runs[1]);
}

std::vector<FrameMotion> shaking(double drift_px, double shake_px, int count) {
  std::vector<FrameMotion> motion;
  for (int k = 0; k < count; ++k) {
    FrameMotion m;
    m.frame = k;
    m.time_s = k / 30.0;
    m.frame_from_reference(0, 2) = drift_px * k + shake_px * std::sin(2 * kPi * 7.5 * m.time_s);
    m.state = k == 0 ? State::kReference : State::kMeasured;
    motion.push_back(m);
  }
  return motion;
}

TEST(Smoothed, IsTheSameBackwards) {
  Options options;
  options.smoothing_s = 0.3;
  std::vector<FrameMotion> all = shaking(4, 6, 120);
  for (const bool is_rotation : {false, true}) {
    if (is_rotation)
      for (FrameMotion& m : all)
        m.rotation = rotation_from_vector({0.1 * std::sin(9 * m.time_s), 0.2 * m.time_s, 0});
    std::vector<FrameMotion> backwards(all.rbegin(), all.rend());
    for (FrameMotion& m : backwards) m.time_s = -m.time_s;
    const auto steady = smoothed(all, options), back = smoothed(backwards, options);
    for (std::size_t k = 0; k < all.size(); ++k) {
      const FrameMotion &one = steady[k], &other = back[all.size() - 1 - k];
      EXPECT_EQ(one.frame, other.frame);
      EXPECT_TRUE(one.frame_from_reference.isApprox(other.frame_from_reference, 1e-9)) << k;
      if (is_rotation) {
        EXPECT_TRUE(one.rotation->isApprox(*other.rotation, 1e-9)) << k;
      }
    }
  }
}

TEST(Smoothed, KeepsTheShakeAndDropsTheDrift) {
  Options options;
  options.smoothing_s = 0.5;
  const auto still = smoothed(shaking(4, 0, 120), options);
  EXPECT_LT(std::abs(apply(still[60].frame_from_reference, {100, 100}).x() - 100), 1e-6);
  const auto shake = smoothed(shaking(4, 6, 120), options);
  for (int k = 40; k < 80; ++k)
    EXPECT_NEAR(
        apply(shake[static_cast<std::size_t>(k)].frame_from_reference, {100, 100}).x() - 100,
        6 * std::sin(2 * kPi * 7.5 * k / 30.0),
        0.35);
}

TEST(Csv, NumbersAreExact) {
  auto motion = shaking(0.1, 1.0 / 3, 4);
  motion[2].state = State::kBridged;
  motion[3].state = State::kCut;
  motion[3].rms_px = 0.1 + 0.2;
  const std::string text = csv_of(motion);
  EXPECT_THAT(text, testing::EndsWith(",0.30000000000000004,cut\n"));
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 5);
  EXPECT_EQ(std::count(text.begin(), text.end(), ','), 5 * 13);
}

TEST(Cache, KnowsTheFramesItHolds) {
  const test_support::TemporaryFolder folder;
  const disk_cache::Cache cache(folder.path());
  CacheKey key;
  key.video_sha256 = "a";
  std::vector<FrameMotion> motion = shaking(1, 1.0 / 3, 5);
  motion[2].state = State::kBridged;
  motion[2].begins_anew = true;
  motion[3].rms_px = 0.1 + 0.2;
  for (const bool is_rotation : {false, true}) {
    if (is_rotation)
      for (FrameMotion& frame : motion) {
        frame.frame_from_reference.setIdentity();
        frame.rotation = Quaternion(Eigen::AngleAxisd(0.1 * frame.time_s, Vector3::UnitX()));
      }
    key.lens = is_rotation ? "lens" : "";
    EXPECT_FALSE(cached(cache, key));
    std::string packed;
    for (const FrameMotion& frame : motion) pack(frame, packed);
    EXPECT_EQ(packed.size(), 5u * (is_rotation ? 56 : 96));
    if (is_rotation)
      store(cache, key, packed);
    else
      store(cache, key, motion);
    ASSERT_TRUE(cached(cache, key));
    EXPECT_EQ(csv_of(*cached(cache, key)), csv_of(motion));
    EXPECT_TRUE(cached(cache, key)->at(2).begins_anew);
    CacheKey shorter = key;
    shorter.frame_count = 3;
    EXPECT_EQ(cached(cache, shorter)->size(), 3u);
  }
  CacheKey other = key;
  other.options.seed = 2;
  EXPECT_FALSE(cached(cache, other));
  other = key;
  other.picture_rate_hz = 10;
  EXPECT_FALSE(cached(cache, other));
  cache.keep(key.entry(), "to the end\nno motion");
  EXPECT_FALSE(cached(cache, key));
}

constexpr int kReachWidth = 640;
constexpr int kReachHeight = 480;
constexpr double kFocalPx = 500;

// A pinhole that turns right: H = K R K^-1, scaled to h33 = 1 as the estimator does.
FrameMotion turned(int frame, double yaw_deg) {
  Homography k;
  k << kFocalPx, 0, kReachWidth / 2.0, 0, kFocalPx, kReachHeight / 2.0, 0, 0, 1;
  const Eigen::AngleAxisd cam_from_reference(-radians(yaw_deg), Vector3::UnitY());
  const Homography h = k * cam_from_reference.toRotationMatrix() * k.inverse();
  FrameMotion motion;
  motion.frame = frame;
  motion.time_s = frame / 30.0;
  motion.frame_from_reference = h / h(2, 2);
  motion.state = frame == 0 ? State::kReference : State::kMeasured;
  return motion;
}

// At the right edge the denominator is cos(yaw) - 320/500 sin(yaw): 0.153 at 50 degrees, 0.049 at
// 55, and below 0 from 57.4 degrees on, where the edge's rays are square to the reference's axis.
TEST(Reach, EndsWhereTheFrameLeavesThePlane) {
  const double yaw_deg[] = {0, 30, 50, 55, 89, 91, 180, -50, -55, 20};
  const bool within[] = {true, true, true, false, false, false, false, true, false, true};
  std::vector<FrameMotion> all;
  for (int k = 0; k < 10; ++k) all.push_back(turned(k, yaw_deg[k]));
  const std::vector<FrameMotion> held = within_reach(all, kReachWidth, kReachHeight);
  for (std::size_t k = 0; k < held.size(); ++k) {
    EXPECT_EQ(is_known(held[k].state), within[k]) << yaw_deg[k];
    if (within[k]) continue;
    EXPECT_EQ(held[k].state, State::kTurnedAway) << yaw_deg[k];
    std::size_t last = k;
    while (!within[last]) --last;
    EXPECT_EQ(held[k].frame_from_reference, all[last].frame_from_reference) << yaw_deg[k];
  }
}

TEST(Reach, ARotationHasNone) {
  FrameMotion motion = turned(0, 120);
  motion.rotation = Quaternion(Eigen::AngleAxisd(radians(120), Vector3::UnitY()));
  motion.state = State::kMeasured;
  EXPECT_EQ(within_reach({motion}, kReachWidth, kReachHeight)[0].state, State::kMeasured);
}

// A turn at a steady rate has no shake, even where h33 changes its sign.
TEST(Reach, TheSmoothedReferenceNeedsNone) {
  std::vector<FrameMotion> all;
  for (int k = 0; k < 120; ++k) all.push_back(turned(k, 0.25 + 1.5 * k));
  Options options;
  options.smoothing_s = 0.1;
  const std::vector<FrameMotion> steady = smoothed(all, options);
  for (std::size_t k = 10; k + 10 < steady.size(); ++k)
    for (const Pixel& p : {Pixel(0, 0), Pixel(640, 480), Pixel(320, 240)})
      EXPECT_LT((apply(steady[k].frame_from_reference, p) - p).norm(), 0.05) << k;
}

}  // namespace

}  // namespace airtruth::motion
