// SPDX-License-Identifier: Apache-2.0
#include "camera/lens/lens.h"

#include <cmath>

#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>

#include "foundation/base/error.h"
#include "foundation/base/seed.h"

namespace airtruth::lens {
namespace {

const ImageSize kSize{1280, 960};
const std::vector<double> kGopro = {0.0645, 0.0160, -0.0109, 0.0044};

std::vector<Lens> every_lens() {
  return {
      pinhole_from_vertical_fov(90, kSize),
      Lens(BrownConrady{{900, 905}, {640.3, 478.2}, {-0.28, 0.09, 1e-3, -5e-4}}, kSize),
      Lens(BrownConrady{{900, 905}, {640.3, 478.2}, {-0.28, 0.09, 1e-3, -5e-4, -0.01}}, kSize),
      Lens(
          BrownConrady{{900, 905}, {640.3, 478.2}, {0.2, 0.05, 1e-4, 2e-4, 0.01, 0.1, 0.02, 0.003}},
          kSize),
      fisheye_from_vertical_fov(170, kSize),
      Lens(Fisheye{{562.67, 563.06}, {637.84, 473.78}, kGopro}, kSize)};
}

TEST(Pinhole, NinetyDegreesOn960RowsIsAFocalLengthOf480) {
  const Lens lens = pinhole_from_vertical_fov(90, kSize);
  EXPECT_NEAR(lens.focal_px(), 480, 1e-9);
  EXPECT_NEAR(lens.vertical_fov_deg(), 90, 1e-9);
  const auto pixel = lens.pixel_from_cam({10, -5, 20});
  ASSERT_TRUE(pixel);
  EXPECT_NEAR(pixel->x(), 640 + 240, 1e-9);
  EXPECT_NEAR(pixel->y(), 480 - 120, 1e-9);
  EXPECT_FALSE(lens.pixel_from_cam({0, 0, -1}));
  EXPECT_FALSE(lens.pixel_from_cam({1, 0, 0}));
}

// theta (1 - 0.1 theta^2) rises to theta = sqrt(1 / 0.3), 105 degrees.
TEST(Fisheye, StatesAnEndThatComesBeforeTheCurves) {
  const auto stated_end = [](double end_rad) {
    return facts_of(Lens(Fisheye{{500, 500}, {640, 480}, {-0.1}, end_rad}, kSize)).max_angle_rad;
  };
  EXPECT_EQ(stated_end(1.5), 1.5);
  EXPECT_EQ(stated_end(1.9), kPi);
  const Lens whole(Fisheye{{500, 500}, {640, 480}, {-0.1}}, kSize);
  EXPECT_NEAR(whole.max_angle_rad(), std::sqrt(1 / 0.3), 1e-3);
  EXPECT_EQ(stated_end(whole.max_angle_rad()), kPi);
}

// 480 columns of pixels that are 4/3 as wide as high are as wide as 640 columns of square ones.
TEST(Pinhole, OfPixelsThatAreNotSquareSeesTheSameView) {
  const Lens square = pinhole_from_vertical_fov(60, {640, 480});
  const Lens wide = pinhole_from_vertical_fov(60, {480, 480}, 4 / 3.0);
  EXPECT_NEAR(wide.vertical_fov_deg(), 60, 1e-9);
  EXPECT_NEAR(wide.horizontal_fov_deg(), square.horizontal_fov_deg(), 1e-9);
}

TEST(Fisheye, EquidistantMapsAngleToRadius) {
  const Lens lens = fisheye_from_vertical_fov(180, kSize);
  const double focal = 480 / (kPi / 2);
  EXPECT_NEAR(lens.focal_px(), focal, 1e-9);
  const auto pixel = lens.pixel_from_cam({0, 1, 0});  // 90 degrees down is the lower border
  ASSERT_TRUE(pixel);
  EXPECT_NEAR(pixel->y(), 960, 1e-9);
  EXPECT_TRUE(lens.pixel_from_cam({1, 0, -1}));  // 135 degrees from the axis
  EXPECT_FALSE(lens.pixel_from_cam({0, 0, -1}));
}

TEST(EveryLens, RoundTripsOverItsWholeValidField) {
  for (const Lens& lens : every_lens()) {
    double worst = 0;
    for (int i = 1; i < 200; ++i) {
      const double angle =
          lens.max_angle_rad() * i / 200.0 * (lens.model().index() == 0 ? 0.99 : 1);
      for (int j = 0; j < 24; ++j) {
        const double turn = 2 * kPi * j / 24;
        const Vector3 ray(
            std::sin(angle) * std::cos(turn), std::sin(angle) * std::sin(turn), std::cos(angle));
        const auto pixel = lens.pixel_from_cam(7.0 * ray);
        ASSERT_TRUE(pixel) << lens.name() << " at " << degrees(angle);
        const auto back = lens.ray_from_pixel(*pixel);
        ASSERT_TRUE(back) << lens.name() << " at " << degrees(angle) << " of "
                          << degrees(lens.max_angle_rad());
        worst = std::max(worst, std::atan2(back->cross(ray).norm(), back->dot(ray)));
      }
    }
    EXPECT_LT(worst, 1e-9) << lens.name();
  }
}

// Random coefficients test the very edge of the field, where the slope of the curve reaches 0.
TEST(EveryLens, RoundTripsForRandomCoefficients) {
  Random random(7);
  double worst = 0;
  for (int i = 0; i < 120; ++i) {
    const auto k = [&](double most) { return random.uniform(-most, most); };
    const std::vector<double> tangential = {k(0.5), k(0.3), k(0.01), k(0.01), k(0.2)};
    const Lens lens =
        i % 2 == 0 ? Lens(Fisheye{{500, 510}, {640, 480}, {k(0.3), k(0.2), k(0.1), k(0.05)}}, kSize)
                   : Lens(BrownConrady{{500, 510}, {640, 480}, tangential}, kSize);
    for (int j = 0; j < 100; ++j) {
      const double edge = j % 4 == 0 ? std::pow(10, random.uniform(-9, -2)) : random.uniform(0, 1);
      const double angle = lens.max_angle_rad() * (1 - edge);
      const double turn = random.uniform(0, 2 * kPi);
      const Vector3 ray(
          std::sin(angle) * std::cos(turn), std::sin(angle) * std::sin(turn), std::cos(angle));
      const auto pixel = lens.pixel_from_cam(ray);
      ASSERT_TRUE(pixel);
      const auto back = lens.ray_from_pixel(*pixel);
      ASSERT_TRUE(back) << lens.name() << " " << i << " at 1 - " << edge;
      worst = std::max(worst, std::atan2(back->cross(ray).norm(), back->dot(ray)));
    }
  }
  EXPECT_LT(worst, 1e-9);
}

// Newton's method alone would circle around the bend of this curve for ever.
TEST(Fisheye, InverseDoesNotCircle) {
  const Lens lens(Fisheye{{500, 510}, {640, 480}, {0.2700, 0.1117, -0.0664, 0.0017}}, kSize);
  for (int i = 1; i < 5000; ++i) {
    const double angle = lens.max_angle_rad() * i / 5000;
    const auto back =
        lens.ray_from_pixel(*lens.pixel_from_cam({std::sin(angle), 0, std::cos(angle)}));
    ASSERT_TRUE(back);
    ASSERT_NEAR(std::atan2(back->x(), back->z()), angle, 1e-9);
  }
}

TEST(Fisheye, EndsWhereItsCalibrationSaysSo) {
  const Lens lens(Fisheye{{500, 500}, {640, 480}, {0, 0, 0, 0}, radians(60)}, kSize);
  EXPECT_TRUE(lens.pixel_from_cam({std::sin(radians(59.9)), 0, std::cos(radians(59.9))}));
  EXPECT_FALSE(lens.pixel_from_cam({std::sin(radians(60.1)), 0, std::cos(radians(60.1))}));
  EXPECT_TRUE(lens.ray_from_pixel({640 + 500 * radians(59.9), 480}));
  EXPECT_FALSE(lens.ray_from_pixel({640 + 500 * radians(60.1), 480}));
}

TEST(EveryLens, HasNoPixelBeyondItsField) {
  for (const Lens& lens : every_lens()) {
    if (lens.max_angle_rad() >= kPi) continue;
    const double angle = lens.max_angle_rad() + 1e-6;
    EXPECT_FALSE(lens.pixel_from_cam({std::sin(angle), 0, std::cos(angle)})) << lens.name();
  }
}

// OpenCV's pixels are integer-centred: its (0, 0) is the centre of the first pixel, airtruth's is
// the corner.
TEST(EveryLens, ProjectsAsOpenCvDoes) {
  Random random(3);
  for (const Lens& lens : every_lens()) {
    for (int i = 0; i < 200; ++i) {
      const double limit = std::min(lens.max_angle_rad(), 1.2) * 0.95;
      const double angle = random.uniform(0.01, limit);
      const double turn = random.uniform(0, 2 * kPi);
      const Vector3 p = random.uniform(1, 500) * Vector3(std::sin(angle) * std::cos(turn),
                                                         std::sin(angle) * std::sin(turn),
                                                         std::cos(angle));
      const std::vector<cv::Point3d> points = {{p.x(), p.y(), p.z()}};
      std::vector<cv::Point2d> projected;
      const cv::Vec3d zero(0, 0, 0);
      std::visit(
          [&](const auto& model) {
            const cv::Matx33d k(model.focal_px.x(),
                                0,
                                model.principal_point_px.x() - 0.5,
                                0,
                                model.focal_px.y(),
                                model.principal_point_px.y() - 0.5,
                                0,
                                0,
                                1);
            if constexpr (std::is_same_v<std::decay_t<decltype(model)>, Fisheye>) {
              cv::fisheye::projectPoints(points, projected, zero, zero, k, model.distortion);
            } else if constexpr (std::is_same_v<std::decay_t<decltype(model)>, BrownConrady>) {
              cv::projectPoints(points, zero, zero, k, model.distortion, projected);
            } else {
              cv::projectPoints(points, zero, zero, k, cv::noArray(), projected);
            }
          },
          lens.model());
      const auto ours = lens.pixel_from_cam(p);
      ASSERT_TRUE(ours);
      EXPECT_NEAR(ours->x() - 0.5, projected[0].x, 1e-8) << lens.name();
      EXPECT_NEAR(ours->y() - 0.5, projected[0].y, 1e-8) << lens.name();
    }
  }
}

// The root mean square, and the worst pixel, of the best homography for a turn about y.
// docs/lenses.md.
std::pair<double, double> misfit_of_a_plane(const Lens& lens, double yaw_deg) {
  const Eigen::AngleAxisd turn(radians(yaw_deg), Vector3::UnitY());
  std::vector<cv::Point2d> from;
  std::vector<cv::Point2d> to;
  for (int y = 0; y <= kSize.height; y += 20)
    for (int x = 0; x <= kSize.width; x += 20) {
      const auto ray = lens.ray_from_pixel({double(x), double(y)});
      const auto pixel = ray ? lens.pixel_from_cam(turn * *ray) : std::nullopt;
      if (!pixel || pixel->x() < 0 || pixel->x() > kSize.width || pixel->y() < 0 ||
          pixel->y() > kSize.height)
        continue;
      from.emplace_back(x, y);
      to.emplace_back(pixel->x(), pixel->y());
    }
  std::vector<cv::Point2d> moved;
  cv::perspectiveTransform(from, moved, cv::findHomography(from, to, 0));
  double sum = 0;
  double worst = 0;
  for (std::size_t i = 0; i < to.size(); ++i) {
    const double miss = cv::norm(moved[i] - to[i]);
    sum += miss * miss;
    worst = std::max(worst, miss);
  }
  return {std::sqrt(sum / static_cast<double>(to.size())), worst};
}

TEST(Lens, APlaneFitsATurnThroughAPinholeAlone) {
  EXPECT_LT(misfit_of_a_plane(pinhole_from_vertical_fov(90, kSize), 5).second, 1e-3);
  const double focal = 640 / radians(60);
  const Lens wide(Fisheye{{focal, focal}, {640, 480}, {0, 0, 0, 0}}, kSize);
  const auto [rms, worst] = misfit_of_a_plane(wide, 5);
  EXPECT_NEAR(rms, 5.22, 0.1);
  EXPECT_NEAR(worst, 16.15, 0.3);
}

TEST(Lens, RefusesNonsense) {
  EXPECT_THROW(Lens(Pinhole{{-480, 480}, {640, 480}}, kSize), Error);
  EXPECT_THROW(Lens(Pinhole{{480, NAN}, {640, 480}}, kSize), Error);
  EXPECT_THROW(Lens(BrownConrady{{480, 480}, {640, 480}, {0.1, 0.2, 0.3}}, kSize), Error);
  EXPECT_THROW(Lens(Fisheye{{480, 480}, {640, 480}, {-1e9, 0, 0, 0}}, kSize), Error);
  EXPECT_THROW(pinhole_from_vertical_fov(180, kSize), Error);
  EXPECT_THROW(pinhole_from_vertical_fov(0, kSize), Error);
  EXPECT_THROW(fisheye_from_vertical_fov(361, kSize), Error);
}

}  // namespace
}  // namespace airtruth::lens
