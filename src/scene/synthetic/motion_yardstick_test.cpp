// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include <gtest/gtest.h>

#include "camera/focal_length/lens_estimator.h"
#include "camera/lens/calibration_file.h"
#include "camera/motion/estimator.h"
#include "camera/motion/motion.h"
#include "foundation/base/median.h"
#include "scene/synthetic/flight.h"
#include "support/far_field.h"
#include "support/shared_folder.h"

// Compares measured motion with known motion: a pinhole that only rotates, so that a homography is
// exact, with the own aircraft in view and a fifth of the picture moving independently.
namespace airtruth::synthetic {
namespace {

constexpr int kFrames = 1000;

// Mean distance, over the image's corners, between the points to which two homographies map them.
double corner_error_px(const Homography& measured,
                       const Homography& truth,
                       double width,
                       double height) {
  double sum = 0;
  for (const Pixel& corner : {Pixel(0, 0), Pixel(width, 0), Pixel(0, height), Pixel(width, height)})
    sum += (apply(measured, corner) - apply(truth, corner)).norm();
  return sum / 4;
}

// The homography of a pinhole that rotates.
Homography of_pinhole(const lens::Lens& lens, const Quaternion& cam_from_reference) {
  const auto [width, height] = lens.size();
  Homography camera = Homography::Identity();
  camera(0, 0) = camera(1, 1) = lens.focal_px();
  camera(0, 2) = width / 2.0, camera(1, 2) = height / 2.0;
  return camera * cam_from_reference.toRotationMatrix() * camera.inverse();
}

// Both motion models with a pinhole that only rotates.
TEST(MotionYardstick, FrameToFrameErrorAtTheCornersIsBelowAThirdOfAPixel) {
  FlightOptions options;
  options.width = 640;
  options.height = 480;
  options.frame_count = kFrames;
  options.clutter = 0.2;
  options.translate = false;
  const Flight flight(options);
  struct Model {
    const char* name;
    motion::Estimator estimator;
    std::vector<double> between_frames_px;
    Homography before = Homography::Identity();
  };
  std::array<Model, 2> models = {
      {{"homography", motion::Estimator(options.width, options.height, &flight.own_aircraft()), {}},
       {"rotation", motion::Estimator(flight.lens(), {}, &flight.own_aircraft()), {}}}};
  Homography truth_before = Homography::Identity();
  for (int k = 0; k < kFrames; ++k) {
    const image::Picture picture = flight.frame(k);
    const Homography truth = frame_from_first(flight, k);
    for (Model& model : models) {
      const motion::FrameMotion moved = model.estimator.next(picture, k / options.frame_rate_hz);
      const Homography measured =
          moved.rotation ? of_pinhole(flight.lens(), *moved.rotation) : moved.frame_from_reference;
      if (k > 0)
        model.between_frames_px.push_back(corner_error_px(measured * model.before.inverse(),
                                                          truth * truth_before.inverse(),
                                                          options.width,
                                                          options.height));
      model.before = measured;
      if (k == 10 || k == 100 || k == 300 || k == kFrames - 1)
        std::printf("%s against the first frame at %4d: %.2f px\n",
                    model.name,
                    k,
                    corner_error_px(measured, truth, options.width, options.height));
    }
    truth_before = truth;
  }
  for (Model& model : models) {
    std::vector<double>& errors_px = model.between_frames_px;
    std::sort(errors_px.begin(), errors_px.end());
    std::printf("%s, frame to frame: median %.3f px, 95 %% below %.3f px\n",
                model.name,
                median(errors_px),
                errors_px[errors_px.size() * 95 / 100]);
    EXPECT_LT(median(errors_px), 0.3) << model.name;
  }
}

// Distances between the predicted and the true pixels of far points that were at the image's edge
// in the first frame.
std::vector<double> edge_errors_px(const lens::Lens& lens,
                                   const motion::FrameMotion& measured,
                                   const Quaternion& cam_from_first_cam) {
  const auto [width, height] = lens.size();
  std::vector<double> errors;
  for (const Pixel& edge : {Pixel(20, height / 2.0),
                            Pixel(width - 20, height / 2.0),
                            Pixel(width / 2.0, 20),
                            Pixel(width / 2.0, height - 20)}) {
    const auto ray = lens.ray_from_pixel(edge);
    if (!ray) continue;
    const auto truth = lens.pixel_from_cam(cam_from_first_cam * *ray);
    const auto found = measured.rotation
                           ? lens.pixel_from_cam(*measured.rotation * *ray)
                           : std::optional(apply(measured.frame_from_reference, edge));
    if (truth && found) errors.push_back((*truth - *found).norm());
  }
  return errors;
}

constexpr int kAgainstHomography = 200;

struct Yardstick {
  double median_deg = 0;
  double rotation_edge_px = 0;
  double homography_edge_px = 0;
  int measured = 0;
};

// Part of the picture moves independently, the own aircraft is in view, and the camera flies on
// over the ground. A `clutter` of 0.12 makes more than 40 % of the corners outliers, because its
// discs have more texture than sky and clouds.
Yardstick measure(const lens::Lens& lens, int frames, double clutter) {
  FlightOptions options;
  options.lens = lens;
  options.width = lens.size().width;
  options.height = lens.size().height;
  options.frame_count = frames;
  options.clutter = clutter;
  const Flight flight(options);
  motion::Estimator rotation(lens, {}, &flight.own_aircraft());
  motion::Estimator homography(options.width, options.height, &flight.own_aircraft());
  std::vector<double> errors_deg, rotation_px, homography_px;
  Yardstick result;
  const auto cam_from_world = [&](int k) {
    return Quaternion(cam_from_body() * flight.camera(k).world_from_body.conjugate());
  };
  for (int k = 0; k < frames; ++k) {
    const image::Picture picture = flight.frame(k);
    const double time_s = k / options.frame_rate_hz;
    const Quaternion truth = cam_from_world(k) * cam_from_world(0).conjugate();
    const motion::FrameMotion turned = rotation.next(picture, time_s);
    errors_deg.push_back(degrees(truth.angularDistance(*turned.rotation)));
    result.measured += turned.state == motion::State::kMeasured ? 1 : 0;
    for (const double e : edge_errors_px(lens, turned, truth)) rotation_px.push_back(e);
    // Beyond this frame the homography's error only grows.
    if (k >= kAgainstHomography) continue;
    for (const double e : edge_errors_px(lens, homography.next(picture, time_s), truth))
      homography_px.push_back(e);
  }
  result.median_deg = median(errors_deg);
  result.rotation_edge_px = median(rotation_px);
  result.homography_edge_px = median(homography_px);
  std::printf(
      "%s: rotation against the first frame: median %.4f deg, worst %.4f deg, %d measured; at the "
      "edge "
      "%.3f px, by homography %.3f px\n",
      lens.name(),
      result.median_deg,
      *std::max_element(errors_deg.begin(), errors_deg.end()),
      result.measured,
      result.rotation_edge_px,
      result.homography_edge_px);
  return result;
}

TEST(MotionYardstick, RotationThroughAFisheyeHoldsWithinAFiftiethOfADegreeOver1000Frames) {
  const char* shared = test_support::shared_folder();
  // The calibration is scaled to this size.
  const lens::ImageSize size{640, 480};
  const lens::Lens lens =
      shared == nullptr
          ? lens::Lens(lens::Fisheye{{422, 422}, {478, 355}, {0.06, 0.01, 0, 0}}, size)
          : lens::read_calibration(
                std::string(shared) + "/lens/gopro_hero3plus_1280x960.gyroflow.json", size);
  const Yardstick result = measure(lens, kFrames, 0.12);
  EXPECT_LT(result.median_deg, 0.02);
  EXPECT_LT(3 * result.rotation_edge_px, result.homography_edge_px);
  EXPECT_EQ(result.measured, kFrames - 1);
}

TEST(MotionYardstick, RotationThroughAPinholeIsNoWorseThanAHomography) {
  const Yardstick result = measure(lens::pinhole_from_vertical_fov(60, {640, 480}), 200, 0.12);
  EXPECT_LT(result.median_deg, 0.02);
  EXPECT_LE(result.rotation_edge_px, result.homography_edge_px);
}

// Steep turns low over ground: near ground moves fast through the picture, and only clouds and a
// strip along the horizon follow the camera's rotation alone. The test measures from frame to frame
// over the whole picture, and against the first frame.
TEST(MotionYardstick, InAHardBankLowOverGroundTheRotationIsThatOfTheFarField) {
  const lens::Lens lens = lens::pinhole_from_vertical_fov(50, {640, 480});
  FlightOptions options;
  options.lens = lens;
  options.width = 640;
  options.height = 480;
  options.frame_count = 150;
  options.roll_deg = 45;
  options.altitude_m = 25;
  options.speed_mps = 30;
  options.own_aircraft = false;
  const Flight flight(options);
  motion::Estimator estimator(lens, {});
  const auto cam_from_world = [&](int k) {
    return Quaternion(cam_from_body() * flight.camera(k).world_from_body.conjugate());
  };
  std::vector<double> steps_px, errors_deg;
  double steepest_deg = 0;
  Quaternion before = Quaternion::Identity();
  for (int k = 0; k < options.frame_count; ++k) {
    const auto moved = estimator.next(flight.frame(k), k / options.frame_rate_hz);
    const Quaternion truth = cam_from_world(k) * cam_from_world(0).conjugate();
    errors_deg.push_back(degrees(truth.angularDistance(*moved.rotation)));
    steepest_deg =
        std::max(steepest_deg, std::abs(yaw_pitch_roll(flight.camera(k).world_from_body).roll_deg));
    motion::FrameMotion step = moved;
    step.rotation = *moved.rotation * before.conjugate();
    before = *moved.rotation;
    if (k == 0) continue;
    for (const double e :
         edge_errors_px(lens, step, cam_from_world(k) * cam_from_world(k - 1).conjugate()))
      steps_px.push_back(e);
  }
  std::sort(steps_px.begin(), steps_px.end());
  std::printf(
      "banks up to %.0f deg at %.0f m: frame to frame median %.3f px, 95 %% below %.3f px; against "
      "the first frame median %.3f deg\n",
      steepest_deg,
      options.altitude_m,
      median(steps_px),
      steps_px[steps_px.size() * 95 / 100],
      median(errors_deg));
  EXPECT_GT(steepest_deg, 40);
  // Measured: 0.012 and 0.046; with equal weights for near ground and far points, 0.028 and 0.108.
  EXPECT_LT(median(steps_px), 0.02);
  EXPECT_LT(steps_px[steps_px.size() * 95 / 100], 0.08);
}

// Nothing is visible for a second while the aircraft keeps rolling. Afterwards only the horizon
// shows the level.
TEST(MotionYardstick, TheHorizonPutsTheRotationRightAfterABlank) {
  const lens::Lens lens = lens::fisheye_from_vertical_fov(100, {640, 480});
  FlightOptions options;
  options.lens = lens;
  options.width = 640;
  options.height = 480;
  options.frame_count = 130;
  options.roll_deg = 30;
  const Flight flight(options);
  motion::Estimator estimator(lens, {}, &flight.own_aircraft());
  const auto cam_from_world = [&](int k) {
    return Quaternion(cam_from_body() * flight.camera(k).world_from_body.conjugate());
  };
  std::vector<double> before_deg, after_deg, carried_on_deg;
  Quaternion last_before = Quaternion::Identity();
  for (int k = 0; k < options.frame_count; ++k) {
    image::Picture picture = flight.frame(k);
    const bool blank = k >= 60 && k < 90;
    if (blank)
      for (image::Plane& plane : picture.planes)
        for (int y = 0; y < plane.height; ++y) std::fill_n(plane.row(y), plane.width, 128);
    const auto moved = estimator.next(picture, k / options.frame_rate_hz);
    const Vector3 up = cam_from_world(0) * Vector3(0, 0, -1);
    const Vector3 truth = cam_from_world(k) * Vector3(0, 0, -1);
    const double off = degrees(std::acos(std::min(1.0, (*moved.rotation * up).dot(truth))));
    if (k < 60) before_deg.push_back(off), last_before = *moved.rotation;
    if (k >= 92) {
      after_deg.push_back(off);
      carried_on_deg.push_back(degrees(std::acos(std::min(1.0, (last_before * up).dot(truth)))));
    }
  }
  std::printf("level: before the blank %.3f deg, after it %.3f deg (carried on: %.1f)\n",
              median(before_deg),
              median(after_deg),
              median(carried_on_deg));
  EXPECT_LT(median(before_deg), 0.02);
  EXPECT_LT(median(after_deg), 0.5);
  EXPECT_GT(median(carried_on_deg), 5);
}

TEST(LensYardstick, AFlightInTurnsTellsItsLens) {
  for (const lens::Lens& lens : {lens::pinhole_from_vertical_fov(60, {640, 480}),
                                 lens::fisheye_from_vertical_fov(100, {640, 480}),
                                 lens::pinhole_from_vertical_fov(60, {480, 480}, 4 / 3.0)}) {
    const lens::ImageSize size = lens.size();
    const double fx_px = lens::facts_of(lens).focal_px[0];
    const double fy_px = lens::facts_of(lens).focal_px[1];
    FlightOptions options;
    options.lens = lens;
    options.width = size.width;
    options.height = size.height;
    options.frame_count = 260;
    options.roll_deg = 25;
    const Flight flight(options);
    const auto estimator_of = [&] {
      return focal_length::LensEstimator(
          size.width, size.height, &flight.own_aircraft(), fy_px / fx_px);
    };
    auto estimator = estimator_of(), first = estimator_of(), second = estimator_of();
    for (int k = 0; k < options.frame_count; ++k) {
      const image::Picture frame = flight.frame(k);
      estimator.add(frame);
      (2 * k < options.frame_count ? first : second).add(frame);
    }
    std::string why;
    const auto found = estimator.result(why);
    ASSERT_TRUE(found) << lens.name() << ": " << why;
    // Each half's interval holds what the other half gives, and the true value.
    const auto one = first.result(why);
    const auto other = second.result(why);
    ASSERT_TRUE(one && other) << lens.name() << ": " << why;
    const auto holds = [](const focal_length::LensEstimator::Result& interval, double focal_px) {
      return interval.low_px <= focal_px && focal_px <= interval.high_px;
    };
    EXPECT_TRUE(holds(*one, other->focal_px) && holds(*other, one->focal_px)) << lens.name();
    EXPECT_TRUE(holds(*one, fy_px) && holds(*other, fy_px)) << lens.name();
    std::printf("%s: %.1f px, %.1f to %.1f, true %.1f, %d pairs, %.2f px (other kind %.2f)\n",
                found->fisheye ? "fisheye" : "pinhole",
                found->focal_px,
                found->low_px,
                found->high_px,
                fy_px,
                found->pairs,
                found->rms_px,
                found->other_rms_px);
    EXPECT_EQ(found->fisheye, std::holds_alternative<lens::Fisheye>(lens.model()));
    EXPECT_NEAR(found->focal_px, fy_px, 0.05 * fy_px);
    EXPECT_TRUE(found->is_certain) << why;
    EXPECT_LE(found->low_px, fy_px);
    EXPECT_GE(found->high_px, fy_px);
  }
}

// A focal length of 7.2 widths of the picture, where the search ends at 6.
TEST(LensYardstick, AnIntervalThatReachesTheEndOfTheSearchIsOpen) {
  FlightOptions options;
  options.seed = 4;
  options.width = 320;
  options.height = 240;
  options.vertical_fov_deg = 6;
  options.frame_count = 200;
  options.shake_deg = 1;
  options.own_aircraft = false;
  const Flight flight(options);
  focal_length::LensEstimator estimator(320, 240);
  for (int k = 0; k < options.frame_count; ++k) estimator.add(flight.frame(k));
  std::string why;
  const auto found = estimator.result(why);
  ASSERT_TRUE(found) << why;
  EXPECT_FALSE(found->is_certain);
  EXPECT_TRUE(found->is_open_high);
  EXPECT_NE(why.find(" to 1920 px or more"), std::string::npos) << why;
}

TEST(LensYardstick, AStillCameraIsRefused) {
  FlightOptions options;
  options.width = 320;
  options.height = 240;
  options.frame_count = 20;
  options.shake_deg = 0;
  const Flight flight(options);
  focal_length::LensEstimator estimator(320, 240);
  for (int k = 0; k < options.frame_count; ++k) estimator.add(flight.frame(k));
  std::string why;
  EXPECT_FALSE(estimator.result(why));
  EXPECT_NE(why.find("turns"), std::string::npos) << why;
}

}  // namespace
}  // namespace airtruth::synthetic
