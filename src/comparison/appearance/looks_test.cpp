// SPDX-License-Identifier: Apache-2.0
#include "comparison/appearance/looks.h"

#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "comparison/appearance/segment.h"
#include "foundation/base/seed.h"

namespace airtruth::appearance {
namespace {

image::Picture grey_picture(int width,
                            int height,
                            const std::function<double(double, double)>& value) {
  image::Picture picture = image::make_picture(width, height, {image::Chroma::kNone});
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      picture.planes[0].row(y)[x] =
          static_cast<std::uint8_t>(std::lround(std::clamp(value(x + 0.5, y + 0.5), 0.0, 255.0)));
  return picture;
}

cv::Mat grey_mat(int side, const std::function<double(double, double)>& value) {
  cv::Mat grey(side, side, CV_32F);
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x)
      grey.at<float>(y, x) = static_cast<float>(value(x + 0.5, y + 0.5));
  return grey;
}

bool inside(const Box& box, double x, double y) {
  return x > box.x && x < box.right() && y > box.y && y < box.bottom();
}

// The step from 0 to 1 at 0, blurred by a Gaussian.
double blurred_step(double x, double sigma) { return 0.5 * std::erfc(-x / (sigma * std::sqrt(2))); }

TEST(Segment, FindsTheTightBoxWithinALooseOneOnANoisySlopingSky) {
  Random noise(3);
  for (const Box& truth : {Box{100, 70, 24, 9}, Box{61, 52, 5, 3}, Box{140, 90, 11, 40}}) {
    for (const double contrast : {-60.0, 25.0}) {
      const image::Picture picture = grey_picture(240, 180, [&](double x, double y) {
        const double sky = 120 + 0.15 * x - 0.1 * y + 1.2 * noise.normal();
        return inside(truth, x, y) ? sky + contrast : sky;
      });
      const double larger = std::max(truth.width, truth.height);
      const Box loose{truth.x - 0.5 * larger,
                      truth.y - 0.7 * larger,
                      truth.width + 1.2 * larger,
                      truth.height + 1.1 * larger};
      const auto seen = seen_in(picture, loose);
      ASSERT_TRUE(seen) << truth.width;
      EXPECT_NEAR(seen->box.x, truth.x, 1);
      EXPECT_NEAR(seen->box.y, truth.y, 1);
      EXPECT_NEAR(seen->box.right(), truth.right(), 1);
      EXPECT_NEAR(seen->box.bottom(), truth.bottom(), 1);
      EXPECT_EQ(seen->mask.cols, int(seen->box.width));
      EXPECT_EQ(seen->mask.rows, int(seen->box.height));
    }
  }
}

TEST(Segment, FindsNothingWhereNothingStandsOutOrItCannotBeBounded) {
  Random noise(4);
  const auto sky = [&](double, double) { return 120 + 1.5 * noise.normal(); };
  EXPECT_FALSE(seen_in(grey_picture(200, 200, sky), {80, 80, 30, 20}));
  // A mast from the bottom of the picture up: what stands out goes on beyond the box.
  const auto mast = [&](double x, double y) { return x > 92 && x < 98 && y > 70 ? 30 : sky(x, y); };
  EXPECT_FALSE(seen_in(grey_picture(200, 200, mast), {80, 80, 30, 20}));
  EXPECT_FALSE(seen_in(grey_picture(200, 200, sky), {185, 80, 30, 20}));
}

TEST(Looks, ContrastAboveAndBelowAreTheStepsThatWerePutIn) {
  // 20 x 6 px: 40 below over three quarters of it, 30 above over the rest, on a slope.
  const Box box{60, 50, 20, 6};
  const image::Picture picture = grey_picture(160, 120, [&](double x, double y) {
    const double sky = 100 + 0.25 * (x - 0.5);
    return inside(box, x, y) ? (x < 75 ? sky - 40 : sky + 30) : sky;
  });
  const auto patch = patch_of(picture, box);
  ASSERT_TRUE(patch);
  const Looks looks = looks_of(*patch);
  EXPECT_NEAR(looks.peak_above, 30, 1);
  EXPECT_NEAR(looks.peak_below, -40, 1);
  EXPECT_NEAR(looks.mean_above, 30 * 0.25, 0.5);
  EXPECT_NEAR(looks.mean_below, -40 * 0.75, 0.5);
  EXPECT_NEAR(looks.centre_px.x(), 70, 0.01);
  EXPECT_NEAR(looks.centre_px.y(), 53, 0.01);
}

TEST(Looks, BrightestDecileStrongestRedAndLongestSideAreThosePutIn) {
  // 20 x 5 px of 60 before 120, with 10 px of 80: a tenth. Cr is 28 over four of them, 0 elsewhere.
  const Box box{60, 50, 20, 5};
  image::Picture picture = image::make_picture(
      160, 120, {image::Chroma::k444, image::Matrix::kBt601, image::Range::kFull});
  for (int y = 0; y < 120; ++y)
    for (int x = 0; x < 160; ++x) {
      const bool red = x >= 70 && x < 72 && y >= 51 && y < 53;
      picture.planes[0].row(y)[x] = inside(box, x + 0.5, y + 0.5) ? (x < 62 ? 80 : 60) : 120;
      picture.planes[1].row(y)[x] = 128;
      picture.planes[2].row(y)[x] = red ? 156 : 128;
    }
  const Looks looks = looks_of(*patch_of(picture, box));
  EXPECT_EQ(looks.longest_px, 20);
  EXPECT_NEAR(looks.brightest_decile, 80, 0.5);
  EXPECT_NEAR(looks.strongest_red, 28, 1);
}

TEST(Looks, AnAircraftOfFivePixelsIsMeasured) {
  const Box box{60, 50, 5, 2};
  const image::Picture picture =
      grey_picture(160, 120, [&](double x, double y) { return inside(box, x, y) ? 70 : 110; });
  const auto seen = seen_in(picture, box);
  ASSERT_TRUE(seen);
  EXPECT_EQ(seen->box, box);
  const Looks looks = looks_of(*patch_of(picture, seen->box));
  EXPECT_NEAR(looks.mean_below, -40, 0.5);
  EXPECT_EQ(looks.peak_above, 0);
  EXPECT_GT(looks.edge_width_px, 0);
}

TEST(Looks, AStripOfGroundAcrossThePatchIsNotTheAircraft) {
  const Box box{100, 70, 47, 14};
  const image::Picture picture = grey_picture(240, 180, [&](double x, double y) {
    return inside(box, x, y) ? 110 : y > 94 && y < 112 ? 100 : 150;
  });
  const Looks looks = looks_of(*patch_of(picture, box));
  EXPECT_EQ(looks.longest_px, 47);
  EXPECT_NEAR(looks.contrast, -40, 0.5);
  EXPECT_NEAR(looks.centre_px.y(), 77, 0.01);
}

TEST(Outline, EdgeOfABlurredStepIsTheGaussians) {
  // From 10 to 90 % of a Gaussian's integral: 2 x 1.2816 sigma. Straight lines between samples are
  // one more blur, of 1/6 px^2.
  for (const double sigma : {0.8, 1.2, 1.6}) {
    const cv::Mat grey = grey_mat(
        64, [&](double x, double y) { return 150 - 80 * blurred_step(x + 0.35 * y - 43, sigma); });
    const cv::Mat silhouette = grey < 110;
    const cv::Mat level(grey.size(), CV_32F, cv::Scalar(150));
    const double across = sigma / std::hypot(1, 0.35);  // the step runs along a slanted line
    const Outline outline = outline_of(grey, silhouette, level);
    const double expected = 2 * 1.2816 * std::sqrt(across * across + 1.0 / 6);
    EXPECT_NEAR(outline.edge_width_px, expected, 0.04 * expected) << sigma;
    EXPECT_NEAR(outline.halo, 0, 0.01) << sigma;
  }
}

TEST(Outline, HaloIsTheOvershootOfAnUnsharpMask) {
  const double sigma = 1.0, amount = 0.8, radius = 1.2;
  const auto sharpened = [&](double x) {
    return (1 + amount) * blurred_step(x, sigma) -
           amount * blurred_step(x, std::hypot(sigma, radius));
  };
  double expected = 0;
  for (double x = 0; x < 6; x += 0.01) expected = std::max(expected, sharpened(x) - 1);
  for (const double sign : {1.0, -1.0}) {  // a dark and a bright aircraft
    const cv::Mat grey =
        grey_mat(64, [&](double x, double) { return 128 + sign * 50 * (sharpened(x - 31.3) - 1); });
    const cv::Mat silhouette = sign > 0 ? grey < 103 : grey > 153;
    const cv::Mat level(grey.size(), CV_32F, cv::Scalar(128));
    // A share of the step from the aircraft's own undershoot to the sky.
    const double share = expected / (1 + expected);
    EXPECT_NEAR(outline_of(grey, silhouette, level).halo, share, 0.02) << sign;
  }
}

}  // namespace
}  // namespace airtruth::appearance
