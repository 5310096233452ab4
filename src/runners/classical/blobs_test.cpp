// SPDX-License-Identifier: Apache-2.0
#include "runners/classical/blobs.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "runners/classical/classical.h"
#include "runners/classical/region.h"
#include "runners/classical/scale_space.h"
#include "support/classical_flights.h"

namespace airtruth::classical {
namespace {

// Samples of level 0 keep this share of the noise of the picture's pixels: the norm of the kernel
// [1 2 1; 2 4 2; 1 2 1] / 16.
constexpr double kNoiseShare = 0.375;

// The smoothing by [1 2 1] keeps this much of the contrast of a target whose middle is a pixel's.
double kept_by_smoothing(const Target& target) {
  const auto along = [](double sigma) { return 0.5 + 0.5 * std::exp(-0.5 / (sigma * sigma)); };
  return along(target.sigma_px.x()) * along(target.sigma_px.y());
}

// Contrast and noise are stated, so the ratio is known: a single sample of the smoothed picture has
// kNoiseShare of the noise of a pixel.
TEST(Blob, HasTheContrastToNoiseThatItWasMadeWith) {
  const double noise = 3;
  for (const double contrast : {-60.0, -30.0, 30.0}) {
    const Target target{{150.5, 100.5}, contrast, {1.3, 1.3}};
    std::mt19937 random(7);
    double sum = 0;
    constexpr int kTrials = 30;
    for (int trial = 0; trial < kTrials; ++trial) {
      const auto levels = scale_space(sky({target}, noise, random));
      const auto blob = blob_at(levels, 0, {150, 100});
      ASSERT_TRUE(blob);
      sum += blob->contrast_to_noise;
    }
    const double known = std::abs(contrast) * kept_by_smoothing(target) / (kNoiseShare * noise);
    // The larger of two estimates of the noise is a little too large.
    EXPECT_NEAR(sum / kTrials, 0.97 * known, 0.06 * known) << contrast;
  }
}

// An independent estimate of the constants: from the samples themselves.
TEST(ScaleSpace, NoiseAndItsResponseAreAsStated) {
  std::mt19937 random(3);
  const double noise = 4;
  const auto levels = scale_space(sky({}, noise, random, 640, 480));
  const Level& level = levels.front();
  double sum = 0;
  for (int y = 20; y < 460; ++y)
    for (int x = 20; x < 620; ++x) {
      const double off = level.picture.at<short>(y, x) / double(kGreyScale) - 120 - 0.05 * y;
      sum += off * off;
    }
  const double sigma = std::sqrt(sum / (440.0 * 600));
  EXPECT_NEAR(sigma, kNoiseShare * noise, 0.02 * noise);
  const double typical = cv::mean(level.typical)[0] / kGreyScale;
  EXPECT_NEAR(typical / sigma, Level::quietest() / (kGreyScale / std::sqrt(12.0)), 0.08);
}

// Noise alone exceeds a threshold about as often as as many independent normal samples would; the
// confident score follows from that number. A lower threshold is reached often enough to be
// counted.
TEST(Confident, NoiseExceedsAThresholdAboutAsOftenAsNormalSamples) {
  constexpr double kThreshold = 4.5;
  constexpr int kFrames = 40;
  std::mt19937 random(11);
  int exceeding = 0;
  for (int k = 0; k < kFrames; ++k)
    for (const Blob& blob : blobs_of(scale_space(sky({}, 4, random)), {2, 1000}))
      exceeding += blob.contrast_to_noise >= kThreshold ? 1 : 0;
  const double samples = 4.0 / 3 * kWidth * kHeight;
  const double expected = kFrames * samples * std::erfc(kThreshold / std::sqrt(2.0));
  // The noise is itself an estimate, of some hundred samples.
  EXPECT_LE(exceeding, 2 * expected);
  EXPECT_GE(exceeding, 0.02 * expected);
}

// White noise of a known standard deviation is found again from the responses that it makes: on
// level 0 to a quarter (the larger of two estimates), on coarser ones on the safe side.
TEST(Surroundings, NoiseFollowsFromItsResponses) {
  const double noise = 6;
  std::mt19937 random(5);
  const auto levels = scale_space(sky({}, noise, random, 640, 480));
  for (const std::size_t number : {0U, 1U}) {
    const Level& level = levels[number];
    double sum = 0, squares = 0;
    int count = 0, samples = 0;
    for (int y = 20; y < level.picture.rows - 20; y += 9)
      for (int x = 20; x < level.picture.cols - 20; x += 9, ++count)
        sum += *noise_of_responses(level, {x, y}, {});
    for (int y = 20; y < level.picture.rows - 20; ++y)
      for (int x = 20; x < level.picture.cols - 20; ++x, ++samples) {
        const double clear = kGreyScale * (120 + 0.05 * level.step * y);
        squares += std::pow(level.picture.at<short>(y, x) - clear, 2);
      }
    const double ratio = sum / count / std::sqrt(squares / samples);
    EXPECT_GT(ratio, 0.95) << number;
    EXPECT_LT(ratio, number == 0 ? 1.3 : 2.2) << number;
  }
}

// An independent estimate of what white noise makes of the largest response of a block, and what a
// box of noise says of parts: what its ring says.
TEST(Parts, NoiseIsAsStated) {
  const double noise = 6;
  std::mt19937 random(8);
  const auto levels = scale_space(sky({}, noise, random, 640, 480));
  const Level& level = levels.front();
  double squares = 0;
  for (int by = 3; by < level.largest.rows - 3; ++by)
    for (int bx = 3; bx < level.largest.cols - 3; ++bx)
      squares += std::pow(level.largest.at<short>(by, bx) / double(kGreyScale), 2);
  const double rms = std::sqrt(squares / ((level.largest.rows - 6) * (level.largest.cols - 6)));
  EXPECT_NEAR(rms / (kNoiseShare * noise), kLargestOfBlock, 0.05 * kLargestOfBlock);
  double most = 0;
  for (int y = 40; y < 380; y += 20)
    for (int x = 40; x < 500; x += 20)
      for (const double side : {30.0, 80.0})
        most =
            std::max(most, parts_within(level, {double(x), double(y), side, side / 2})->to_noise);
  EXPECT_LT(most, kLeastContrastToNoise);
}

// Blocks whose responses are so many times those around say so, and the box that holds them and
// little else is the likeliest.
TEST(Parts, WholeIsTheBoxThatHoldsThemAll) {
  std::mt19937 random(8);
  std::vector<Target> parts;
  for (int x = 200; x <= 260; x += 12)
    parts.push_back({{x + 0.5, 150.5}, x % 24 == 8 ? 40.0 : -40.0});
  const auto levels = scale_space(sky(parts, 2, random, 640, 480));
  const Box all{196, 146, 69, 9};
  const auto whole = whole_of_parts(
      levels, 4, {{226, 146, 39, 9}, {100, 80, 300, 160}, all, {180, 120, 100, 60}, {0, 0, 9, 9}});
  ASSERT_TRUE(whole);
  EXPECT_EQ(whole->box_px.x, all.x);
  EXPECT_EQ(whole->box_px.width, all.width);
  EXPECT_GT(whole->to_noise, 20);
  // A tenth of the blocks makes a third of it.
  const auto diluted = whole_of_parts(levels, 4, {{100, 80, 300, 160}});
  EXPECT_TRUE(!diluted || diluted->to_noise < 0.5 * whole->to_noise);
}

// What stands elsewhere is no noise of an object's ring.
TEST(Blob, KeepsItsScoreAmongOthers) {
  std::vector<Target> targets = {{{160.5, 120.5}, -40}};
  const auto score = [&] {
    std::mt19937 random(2);
    const auto blob = blob_at(scale_space(sky(targets, 2, random)), 0, {160, 120});
    return blob ? blob->contrast_to_noise : 0;
  };
  const double alone = score();
  EXPECT_GT(alone, 20);
  for (int y = 30; y < kHeight; y += 40)
    for (int x = 25; x < kWidth; x += 40)
      if (std::hypot(x - 160, y - 120) > 30) targets.push_back({{x + 0.5, y + 0.5}, -40});
  EXPECT_NEAR(score(), alone, 1e-9);
}

// A bar that is blurred by a Gaussian falls to a share of its middle where the normal distribution
// says; the side follows from that place.
TEST(Region, SideOfABlurredBarIsFoundAgain) {
  const auto below = [](double z) { return 0.5 * std::erfc(-z / std::sqrt(2.0)); };
  for (const double sigma : {0.7, 1.6, 3.2})
    for (const double side : {2.0, 4.0, 8.0, 16.0, 40.0})
      for (const double half : {0.4 * side, 0.5 * side, 0.5 * side + 1.2 * sigma}) {
        const double share = (below((half + side / 2) / sigma) - below((half - side / 2) / sigma)) /
                             (2 * below(side / 2 / sigma) - 1);
        // Where the bar is still flat, no place tells its side.
        if (share > 0.9) continue;
        EXPECT_NEAR(side_before_blur(half, share, sigma), side, 0.02 * side + 0.05 * sigma)
            << sigma << " " << half;
      }
  EXPECT_EQ(side_before_blur(1, 0.3, 2), 0);
}

}  // namespace
}  // namespace airtruth::classical
