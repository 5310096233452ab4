// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstdio>

#include <gtest/gtest.h>

#include "camera/gyro/gyro.h"
#include "camera/horizon/horizon.h"
#include "camera/motion/motion.h"
#include "camera/motion/rotation_fit.h"
#include "camera/motion/shake.h"
#include "foundation/base/error.h"
#include "foundation/base/seed.h"

namespace airtruth::motion {
namespace {

Quaternion turn(double yaw_deg, double pitch_deg, double roll_deg) {
  return world_from_body({yaw_deg, pitch_deg, roll_deg});
}

TEST(RotationFit, HoldsBesideFortyPerCentOfOutliers) {
  Random random(3);
  const Quaternion truth = turn(3, -2, 5);
  std::vector<Bearings> bearings;
  for (int i = 0; i < 300; ++i) {
    const Vector3 a = Vector3(random.uniform(-1, 1), random.uniform(-0.7, 0.7), 1).normalized();
    Vector3 b = truth * a + 3e-4 * Vector3(random.normal(), random.normal(), random.normal());
    if (i % 5 < 2) b = turn(random.uniform(-9, 9), random.uniform(-9, 9), 0) * a;
    bearings.push_back({a, b.normalized()});
  }
  const auto fit = fit_rotation(bearings, 2e-3, 12, 1);
  ASSERT_TRUE(fit);
  EXPECT_LT(degrees(fit->cam_from_reference.angularDistance(truth)), 0.005);
  EXPECT_NEAR(fit->inliers, 180, 12);
  EXPECT_FALSE(fit_rotation({bearings.begin(), bearings.begin() + 5}, 2e-3, 12, 1));
}

// Level ground 30 m below a camera that flies `way_m` ahead, and a fifth as many far points.
std::vector<Bearings> flown_over(const Quaternion& turned, double way_m, bool is_told) {
  Random random(8);
  const Vector3 up(0, -1, 0);  // camera axes
  const double height_m = 30;
  std::vector<Bearings> bearings;
  for (int i = 0; i < 240; ++i) {
    const bool far = i % 6 == 0;
    const double below = far ? random.uniform(-0.1, 0.02) : random.uniform(0.1, 0.5);
    const Vector3 a = Vector3(random.uniform(-0.6, 0.6), below, 1).normalized();
    Vector3 b = a;
    if (below > 0) b -= way_m * a.y() / height_m * Vector3(0.3, 0, 1);  // range = height / sine
    b = turned * b.normalized() + 1e-4 * Vector3(random.normal(), random.normal(), random.normal());
    bearings.push_back({a, b.normalized(), is_told ? nearness_of(a, up, 1) : Nearness{}});
  }
  return bearings;
}

TEST(RotationFit, NearGroundDoesNotPullIt) {
  const Quaternion truth = turn(1, -2, 3);
  const auto error_mrad = [&](double way_m, bool is_told) {
    const auto fit = fit_rotation(flown_over(truth, way_m, is_told), 2e-3, 12, 1);
    return fit ? 1e3 * fit->cam_from_reference.angularDistance(truth) : 1e9;
  };
  const double pulled_mrad = error_mrad(0.25, false);
  const double far_mrad = error_mrad(0.25, true);
  std::printf("pulled by near ground: %.3f mrad; far alone: %.3f mrad\n", pulled_mrad, far_mrad);
  EXPECT_GT(pulled_mrad, 2 * far_mrad);
  EXPECT_LT(far_mrad, 0.25);             // an eighth of the limit
  EXPECT_LT(error_mrad(0, true), 0.03);  // at rest there is no parallax, and all points count
}

std::vector<FrameMotion> shaken(int count) {
  std::vector<FrameMotion> motion;
  for (int k = 0; k < count; ++k) {
    FrameMotion m;
    m.frame = k;
    m.time_s = k / 30.0;
    const double t = m.time_s;
    m.rotation = turn(0.5 * std::sin(2 * kPi * 9 * t), 0.4 * std::sin(2 * kPi * 7 * t + 1), 2 * t);
    m.state = k == 0 ? State::kReference : State::kMeasured;
    motion.push_back(m);
  }
  return motion;
}

// The largest relative error of d/dt of a 9 Hz shake sampled at 30 Hz, against its closed form.
double worst_rate(const std::vector<FrameMotion>& motion) {
  double worst = 0;
  for (std::size_t k = 15; k < 45; ++k) {
    const double t = double(k) / 30.0;
    const Shake shake = shake_of(motion, k);
    const double h = 1e-5;
    const auto at = [](double s) {
      return turn(0.5 * std::sin(2 * kPi * 9 * s), 0.4 * std::sin(2 * kPi * 7 * s + 1), 2 * s);
    };
    const Vector3 truth = vector_from_rotation(at(t + h) * at(t - h).conjugate()) / (2 * h);
    worst = std::max(worst, (shake.rate_radps - truth).norm() / truth.norm());
  }
  return worst;
}

TEST(ShakeOf, KeepsTheRateOfFastShake) {
  const auto motion = shaken(60);
  EXPECT_LT(worst_rate(motion), 0.1);
  // No rate is known across a cut.
  auto cut = motion;
  cut[30].state = State::kCut;
  cut[30].rotation = turn(90, 0, 0);
  EXPECT_LT(shake_of(cut, 29).rate_radps.norm(), 2);
}

TEST(ShakeOf, KeepsTheRateWhereStampsJitter) {
  auto matroska = shaken(60), jittered = shaken(60);
  for (std::size_t k = 0; k < 60; ++k) {
    matroska[k].time_s = std::round(1e3 * matroska[k].time_s) / 1e3;  // its clock is 1 ms
    jittered[k].time_s += 1e-3 * (double(k * k % 3) - 1);
  }
  EXPECT_LT(worst_rate(matroska), 0.1);
  EXPECT_LT(worst_rate(jittered), 0.1);
}

// A turn by 0.5 a t^2 has the rate a t, which a central difference by the times gives exactly.
TEST(ShakeOf, BesideAFrameThatIsLeftOutBothNeighboursCountByTheirTimes) {
  std::vector<FrameMotion> motion = shaken(3);
  motion[2].time_s = 3 / 30.0;
  for (FrameMotion& frame : motion) frame.rotation = turn(90 * frame.time_s * frame.time_s, 0, 0);
  EXPECT_NEAR(shake_of(motion, 1).rate_radps.norm(), radians(180 / 30.0), 1e-9);
}

TEST(Motion, RotationsAreSmoothed) {
  const auto motion = shaken(90);
  Options options;
  options.smoothing_s = 0.3;
  const auto smooth = smoothed(motion, options);
  // Smoothing removes the steady turn and leaves the shake.
  EXPECT_LT(degrees(smooth[45].rotation->angularDistance(Quaternion::Identity())), 1.0);
}

std::vector<std::uint8_t> element(const std::string& key,
                                  char type,
                                  std::uint8_t size,
                                  std::uint16_t count,
                                  std::vector<std::uint8_t> data) {
  std::vector<std::uint8_t> bytes(key.begin(), key.end());
  for (const auto b :
       {std::uint8_t(type), size, std::uint8_t(count >> 8), std::uint8_t(count & 255)})
    bytes.push_back(b);
  bytes.insert(bytes.end(), data.begin(), data.end());
  while (bytes.size() % 4 != 0) bytes.push_back(0);
  return bytes;
}

std::vector<std::uint8_t> together(std::vector<std::uint8_t> a,
                                   const std::vector<std::uint8_t>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

// The angle between the measured and the true up direction.
double off_level_deg(const Quaternion& measured, const Quaternion& truth, const Vector3& up) {
  return degrees(std::acos(std::clamp((measured * up).dot(truth * up), -1.0, 1.0)));
}

// A key frame per second for two hours, each linked with an error of a fiftieth of a degree, drifts
// by more than a degree in all. The horizons are accurate to a third of a degree.
TEST(HorizonHold, HoldsARandomWalkAndLeavesWhatDoesNotStrayAlone) {
  Random random(5);
  const auto noise = [&](double sigma_deg) {
    return turn(0, sigma_deg * random.normal(), sigma_deg * random.normal());
  };
  const Vector3 up = Vector3(0.1, -1, 0.2).normalized();
  for (const double sigma_deg : {0.02, 0.0}) {
    horizon::HorizonHold hold;
    Quaternion error = Quaternion::Identity();
    double worst_free = 0, worst_held = 0;
    for (int k = 0; k < 7200; ++k) {
      const Quaternion truth = turn(0.5 * k, 5 * std::sin(0.1 * k), 20 * std::sin(0.03 * k));
      const Quaternion measured = truth * error;
      hold.see(measured, noise(0.3) * (truth * up));
      worst_free = std::max(worst_free, off_level_deg(measured, truth, up));
      worst_held = std::max(worst_held, off_level_deg(hold.held(measured), truth, up));
      error = error * noise(sigma_deg) * turn(sigma_deg * random.normal(), 0, 0);
      hold.stray(radians(sigma_deg));
    }
    if (sigma_deg > 0) {
      EXPECT_GT(worst_free, 1.4);
      EXPECT_LT(worst_held, 0.7);
    } else {
      EXPECT_LT(worst_held, 1e-5);
    }
  }
}

TEST(HorizonHold, PutsRightWhatWasLostAndForgetsWhatCannotBe) {
  const Vector3 up = Vector3(0, -1, 0.1).normalized();
  horizon::HorizonHold hold;
  for (int k = 0; k < 40; ++k) ASSERT_TRUE(hold.see(Quaternion::Identity(), up));
  // A line in another place, which is straight and level as well.
  EXPECT_FALSE(hold.see(Quaternion::Identity(), turn(0, 0, 25) * up));
  // Tracking stopped for a while, and the rotation missed 20 degrees of yaw and 6 degrees of pitch.
  const Quaternion truth = turn(6, 0, 20);
  hold.stray(0.5);
  EXPECT_GT(off_level_deg(hold.held(Quaternion::Identity()), truth, up), 5);
  EXPECT_TRUE(hold.see(Quaternion::Identity(), truth * up));
  EXPECT_LT(off_level_deg(hold.held(Quaternion::Identity()), truth, up), 0.1);
}

TEST(Gpmf, AGyroStreamIsRead) {
  const auto scale = element("SCAL", 's', 2, 1, {0x01, 0x00});  // 256
  const auto gyro =
      element("GYRO", 's', 6, 2, {0x01, 0x00, 0xff, 0x00, 0x00, 0x80, 0, 0, 0, 0, 0x02, 0x00});
  const auto stream_data = together(scale, gyro);
  const auto stream =
      element("STRM", 0, 1, static_cast<std::uint16_t>(stream_data.size()), stream_data);
  const auto packet = element("DEVC", 0, 1, static_cast<std::uint16_t>(stream.size()), stream);
  const auto samples = gyro::gyro_from_gpmf(packet, 2, 3);
  ASSERT_EQ(samples.size(), 2u);
  EXPECT_DOUBLE_EQ(samples[0].time_s, 2.25);
  EXPECT_TRUE(samples[0].rate_radps.isApprox(Vector3(1, -1, 0.5)));
  EXPECT_TRUE(samples[1].rate_radps.isApprox(Vector3(0, 0, 2)));
  // A packet that is cut off anywhere is read up to that place or not at all.
  for (std::size_t n = 0; n < packet.size(); ++n)
    gyro::gyro_from_gpmf(std::span(packet).first(n), 0, 1);
}

TEST(Gyro, AxesOffsetAndBiasAreSolvedAndAGapIsBridged) {
  auto motion = shaken(120);
  const Quaternion gyro_from_cam = turn(90, 0, 180);
  const Vector3 bias(0.01, -0.02, 0.005);
  const double offset_s = 0.137;
  std::vector<gyro::GyroSample> gyro;
  for (int i = 0; i < 2000; ++i) {
    const double t = i / 400.0 - 0.3;
    const double h = 1e-4;
    const auto at = [](double s) {
      return turn(0.5 * std::sin(2 * kPi * 9 * s), 0.4 * std::sin(2 * kPi * 7 * s + 1), 2 * s);
    };
    const Vector3 in_cam = -vector_from_rotation(at(t + h) * at(t - h).conjugate()) / (2 * h);
    gyro.push_back({t + offset_s, gyro_from_cam * (in_cam - bias)});
  }
  const auto fit = gyro::fit_gyro(gyro, motion);
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->offset_s, offset_s, 0.003);
  EXPECT_GT(fit->correlation, 0.98);
  EXPECT_LT(degrees(fit->cam_from_gyro.angularDistance(gyro_from_cam.conjugate())), 2);
  const auto truth = motion;
  for (std::size_t k = 60; k < 66; ++k) {
    motion[k].state = State::kBridged;
    motion[k].rotation = motion[59].rotation;
  }
  const auto bridged = gyro::bridged_by_gyro(motion, gyro, *fit);
  for (std::size_t k = 60; k < 66; ++k) {
    const double carried_on = degrees(motion[k].rotation->angularDistance(*truth[k].rotation));
    const double by_gyro = degrees(bridged[k].rotation->angularDistance(*truth[k].rotation));
    EXPECT_LT(by_gyro, 0.12) << k << " (carried on: " << carried_on << ")";
  }
  // Tracking that starts anew at the end of the gap stands on the rotation that was held in it. The
  // turn of the gap stays, also over a second gap that the estimator links by itself.
  motion[65].begins_anew = true;
  const Quaternion lost = truth[65].rotation->conjugate() * *motion[65].rotation;
  for (std::size_t k = 66; k < 120; ++k) motion[k].rotation = *truth[k].rotation * lost;
  for (std::size_t k = 90; k < 93; ++k) {
    motion[k].state = State::kBridged;
    motion[k].rotation = motion[89].rotation;
  }
  EXPECT_GT(degrees(motion[119].rotation->angularDistance(*truth[119].rotation)), 0.3);
  const auto after = gyro::bridged_by_gyro(motion, gyro, *fit);
  for (std::size_t k = 65; k < 120; ++k)
    EXPECT_LT(degrees(after[k].rotation->angularDistance(*truth[k].rotation)), 0.25) << k;
}

}  // namespace
}  // namespace airtruth::motion
