// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <gtest/gtest.h>

#include "sequence/insertion/paint.h"

namespace airtruth::insertion {
namespace {

constexpr double kStepOfQp30 = 20;  // 0.625 * 2^(30/6)

image::Picture sky() {
  image::Picture picture = image::make_picture(256, 128, {image::Chroma::k420});
  for (std::size_t p = 0; p < 3; ++p)
    for (int y = 0; y < picture.planes[p].height; ++y)
      for (int x = 0; x < picture.planes[p].width; ++x)
        picture.planes[p].row(y)[x] = static_cast<std::uint8_t>(p == 0 ? 150 + y / 8 : 124);
  return picture;
}

// Striped, so that no codec keeps all of it.
image::Picture with_aircraft(image::Picture picture, int left) {
  for (int y = 60; y < 68; ++y)
    for (int x = left; x < left + 18; ++x)
      picture.planes[0].row(y)[x] = static_cast<std::uint8_t>(60 + 23 * ((x - left + 2 * y) % 5));
  return picture;
}

double rms(const image::Picture& a, const image::Picture& b) {
  double sum = 0;
  for (int y = 0; y < a.height; ++y)
    for (int x = 0; x < a.width; ++x)
      sum += std::pow(static_cast<double>(a.luma().row(y)[x]) - b.luma().row(y)[x], 2);
  return std::sqrt(sum / (a.width * a.height));
}

// A frame through the coder, with the window's samples replaced; what the window became.
image::Picture next_frame(FrameCoder& coder, const PixelBox& box, image::Picture picture) {
  const composite::Coded coded =
      coder.code(box, image::crop(picture, box), image::crop(sky(), box));
  image::paste(picture, coded.with_layer, box.x, box.y);
  coder.finish_frame(picture);
  return image::crop(picture, box);
}

TEST(FrameCoder, PredictsFromTheFrameBeforeAsItWasCoded) {
  const PixelBox box{48, 48, 64, 32};
  const image::Picture true_picture = with_aircraft(sky(), 60);
  FrameCoder coder(kStepOfQp30);
  const image::Picture first = next_frame(coder, box, true_picture.clone());
  const image::Picture second = next_frame(coder, box, true_picture.clone());
  const double lost = rms(first, image::crop(true_picture, box));
  EXPECT_GT(lost, 0.5);
  EXPECT_LT(rms(second, first), lost / 2) << "an aircraft at rest keeps the errors that it has";
}

TEST(FrameCoder, FollowsAWindowThatMoves) {
  FrameCoder coder(kStepOfQp30);
  FrameCoder fresh(kStepOfQp30);
  next_frame(coder, {48, 48, 64, 32}, with_aircraft(sky(), 60));
  const PixelBox moved{64, 48, 64, 32};
  const image::Picture again = with_aircraft(sky(), 76);
  const image::Picture followed = next_frame(coder, moved, again.clone());
  const image::Picture begun = next_frame(fresh, moved, again.clone());
  EXPECT_FALSE(image::identical(followed, begun));
}

TEST(FrameCoder, BeginsAnewWhereNothingIsKept) {
  FrameCoder coder(kStepOfQp30);
  FrameCoder fresh(kStepOfQp30);
  next_frame(coder, {16, 48, 64, 32}, with_aircraft(sky(), 30));
  const PixelBox far{176, 48, 64, 32};
  EXPECT_TRUE(image::identical(next_frame(coder, far, with_aircraft(sky(), 190)),
                               next_frame(fresh, far, with_aircraft(sky(), 190))));
  // A frame without an intruder forgets.
  coder.finish_frame(sky());
  fresh = FrameCoder(kStepOfQp30);
  EXPECT_TRUE(image::identical(next_frame(coder, far, with_aircraft(sky(), 190)),
                               next_frame(fresh, far, with_aircraft(sky(), 190))));
}

TEST(FrameCoder, LosesMoreWithALargerStep) {
  const PixelBox box{48, 48, 64, 32};
  const image::Picture true_picture = with_aircraft(sky(), 60);
  double before = 0;
  for (const double step : {0.1, 5.0, 20.0, 80.0}) {
    FrameCoder coder(step);
    const double lost =
        rms(next_frame(coder, box, true_picture.clone()), image::crop(true_picture, box));
    EXPECT_GT(lost, before) << step;
    before = lost;
  }
}

}  // namespace
}  // namespace airtruth::insertion
