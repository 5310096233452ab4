// SPDX-License-Identifier: Apache-2.0
#include "runners/classical/classical.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <airtruth/metrics.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/classical_flights.h"

namespace airtruth::classical {
namespace {

TEST(Confident, FollowsFromFrameAndRate) {
  // 2 n Q(z) of a frame times the frames of an hour is one.
  const double z = confident_deviations(1.6e6, 30);
  EXPECT_NEAR(1.6e6 * std::erfc(z / std::sqrt(2.0)) * 3600 * 30, 1, 1e-6);
  EXPECT_NEAR(confident_log_ratio(1e5, 30), std::log(1e5 * 108'000), 1e-9);
  // A video that states no rate counts as one of 30 frames a second.
  EXPECT_EQ(confident_deviations(1000, 0), confident_deviations(1000, 30));
  for (const std::string& name : classical_names()) {
    const auto detector = make_classical(name);
    detector->begin(sequence_of(1280, 960));
    ASSERT_TRUE(detector->confident_score()) << name;
    EXPECT_GT(*detector->confident_score(), 5) << name;
    EXPECT_LT(*detector->confident_score(), 30) << name;
  }
}

TEST(Classical, NoiseIsNeverConfident) {
  for (const std::string& name : classical_names()) {
    const auto detector = make_classical(name);
    detector->begin(sequence_of());
    EXPECT_EQ(score_of(name.c_str(), 0, 0.5, *detector->confident_score(), 5).false_alarms, 0)
        << name;
  }
}

// A ring around the target is half cloud and half sky.
TEST(CloseMinusOpen, FindsATargetBesideAnEdge) {
  std::mt19937 random(4);
  image::Picture picture = sky({{{150.5, 114.5}, 50}}, 1.5, random);
  for (int y = 120; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      std::uint8_t& sample = picture.planes[0].row(y)[x];
      sample = static_cast<std::uint8_t>(std::min(255, sample + 60));
    }
  const auto detector = make_classical("cmo");
  detector->begin(sequence_of());
  const auto found = detector->detect({0, 0, &picture, true, {}});
  ASSERT_FALSE(found.empty());
  EXPECT_TRUE(hits(found.front(), {150.5, 114.5}, 5));
}

// A filled ellipse or bar without noise.
image::Picture shape(const Box& box, bool is_ellipse, int level) {
  image::Picture picture = image::make_picture(640, 480, {image::Chroma::kNone});
  for (int y = 0; y < 480; ++y)
    for (int x = 0; x < 640; ++x) {
      const double u = (x + 0.5 - box.x - box.width / 2) / (box.width / 2);
      const double v = (y + 0.5 - box.y - box.height / 2) / (box.height / 2);
      const bool inside = is_ellipse ? u * u + v * v <= 1 : std::abs(u) <= 1 && std::abs(v) <= 1;
      picture.planes[0].row(y)[x] = static_cast<std::uint8_t>(inside ? level : 150);
    }
  return picture;
}

TEST(CloseMinusOpen, BoundsObjectsOfAllSizes) {
  const auto detector = make_classical("cmo");
  for (const int level : {90, 210})
    for (const double size : {3.0, 5.0, 8.0, 13.0, 20.0, 35.0, 60.0, 100.0})
      for (const double aspect : {1.0, 2.0, 4.0}) {
        const Box box{203, 151, size, std::max(2.0, size / aspect)};
        const image::Picture picture = shape(box, aspect < 4, level);
        detector->begin(sequence_of(640, 480));
        const auto found = detector->detect({0, 0, &picture, {}});
        ASSERT_EQ(found.size(), 1U) << size << " / " << aspect << " of " << level;
        EXPECT_GT(evaluation::overlap(found[0].box_px, box), size < 10 ? 0.3 : 0.5)
            << size << " / " << aspect << ": " << found[0].box_px.x << "," << found[0].box_px.y
            << " " << found[0].box_px.width << "x" << found[0].box_px.height;
      }
}

// A bar's box is that of its pixels, without what the smoothing adds: within a pixel or a tenth.
TEST(CloseMinusOpen, BoxesOfBarsAreNotWidenedBySmoothing) {
  const auto detector = make_classical("cmo");
  for (const double width : {4.0, 6.0, 10.0, 14.0, 20.0, 28.0, 40.0})
    for (const double aspect : {1.0, 2.0, 4.0}) {
      const Box box{203, 151, width, std::max(3.0, std::round(width / aspect))};
      const image::Picture picture = shape(box, false, 90);
      detector->begin(sequence_of(640, 480));
      const auto found = detector->detect({0, 0, &picture, {}});
      ASSERT_EQ(found.size(), 1U) << width << " / " << aspect;
      const Box& bounds = found[0].box_px;
      const double within = std::max(1.0, 0.1 * width);
      EXPECT_NEAR(bounds.width, box.width, within) << box.height;
      EXPECT_NEAR(bounds.height, box.height, within) << box.width;
      EXPECT_NEAR(bounds.x, box.x, within);
      EXPECT_NEAR(bounds.y, box.y, within);
    }
}

void fill(image::Picture& picture, const cv::Rect& part, int level) {
  for (int y = part.y; y < part.br().y; ++y)
    for (int x = part.x; x < part.br().x; ++x)
      picture.planes[0].row(y)[x] = static_cast<std::uint8_t>(level);
}

// A long aircraft with windows, engines and a lit tail: neither its parts nor a second one
// elsewhere lower its score.
TEST(CloseMinusOpen, ALargeObjectIsNotItsOwnClutter) {
  const auto strongest = [](bool has_parts, bool has_other) {
    image::Picture picture = shape({203, 151, 60, 12}, false, 90);
    if (has_other) fill(picture, {403, 351, 60, 12}, 90);
    if (has_parts)
      for (const int x : {205, 220, 232, 246, 258}) fill(picture, {x, 154, 3, 3}, 220);
    const auto detector = make_classical("cmo");
    detector->begin(sequence_of(640, 480));
    double score = 0;
    for (const results::Detection& one : detector->detect({0, 0, &picture, true, {}}))
      if (hits(one, {233, 157}, 30)) score = std::max(score, one.score);
    return score;
  };
  for (const bool has_parts : {false, true}) {
    EXPECT_NEAR(strongest(has_parts, true), strongest(has_parts, false), 1e-3) << has_parts;
    EXPECT_GT(strongest(has_parts, true), 0.7 * strongest(false, false)) << has_parts;
  }
}

// A sky of soft clouds, of a third to all of a large aircraft's length.
image::Picture cloudy_sky(std::mt19937& random) {
  image::Picture picture = sky({}, 1, random, 640, 480);
  for (int y = 0; y < 480; ++y)
    for (int x = 0; x < 640; ++x) {
      const double cloud = 5 * std::sin(0.11 * x + 0.02 * y) * std::sin(0.13 * y) +
                           7 * std::sin(0.045 * x - 0.03 * y) * std::cos(0.06 * y + 0.01 * x);
      std::uint8_t& sample = picture.planes[0].row(y)[x];
      sample = static_cast<std::uint8_t>(std::lround(sample + cloud));
    }
  return picture;
}

// An aircraft from the side: a sunlit fuselage with a row of dark windows, a wing in shade that
// slants below it, two engines and a fin. In the mean it differs from the sky by a fraction of what
// its parts do.
Box put_aircraft(image::Picture& picture, int length) {
  const int left = 240, top = 200, unit = length / 24;
  fill(picture, {left, top, length, 2 * unit}, 225);
  for (int window = 2; window < 22; window += 3)
    fill(picture, {left + window * unit, top + unit / 2, unit, unit}, 40);
  for (int down = 0; down < 2 * unit; ++down)
    fill(picture, {left + 9 * unit + 2 * down, top + 2 * unit + down, 5 * unit, 1}, 50);
  for (const int engine : {7, 15})
    fill(picture, {left + engine * unit, top + 2 * unit, 2 * unit, unit}, 30);
  for (int up = 0; up < 3 * unit; ++up)
    fill(picture, {left + length - 3 * unit + up / 2, top - 1 - up, 2 * unit, 1}, 60);
  return {double(left), double(top - 3 * unit), double(length), double(7 * unit)};
}

TEST(CloseMinusOpen, FindsLargeAircraftInACloudySky) {
  const auto detector = make_classical("cmo");
  for (const int length : {70, 100, 150}) {
    std::mt19937 random(6);
    image::Picture picture = cloudy_sky(random);
    const Box box = put_aircraft(picture, length);
    detector->begin(sequence_of(640, 480));
    const auto found = detector->detect({0, 0, &picture, true, {}});
    ASSERT_FALSE(found.empty()) << length;
    const results::Detection& first = found.front();
    // A score at which no other detection of the picture is near.
    EXPECT_GT(first.score, 30) << length;
    EXPECT_GT(evaluation::overlap(first.box_px, box), 0.5)
        << length << ": " << first.box_px.x << "," << first.box_px.y << " " << first.box_px.width
        << "x" << first.box_px.height;
    for (std::size_t other = 1; other < found.size(); ++other)
      EXPECT_LT(found[other].score, 0.5 * first.score) << length;
  }
}

// A mast before the same sky ends nowhere, and a box that holds a part of it has more of it around.
TEST(CloseMinusOpen, AMastBeforeCloudsIsNoAircraft) {
  const auto detector = make_classical("cmo");
  std::mt19937 random(6);
  image::Picture picture = cloudy_sky(random);
  fill(picture, {300, 0, 5, 480}, 60);
  detector->begin(sequence_of(640, 480));
  for (const results::Detection& one : detector->detect({0, 0, &picture, true, {}}))
    EXPECT_LT(one.score, 15) << one.box_px.x << "," << one.box_px.y;
}

// A slanting antenna on a roof responds, and is part of the house: an object must end.
TEST(CloseMinusOpen, AnAntennaIsPartOfItsHouse) {
  const auto detector = make_classical("cmo");
  for (const int height : {6, 9, 12}) {
    image::Picture picture = shape({0, 0, 1, 1}, false, 150);
    fill(picture, {200, 240, 240, 240}, 90);
    for (int up = 0; up < height; ++up) fill(picture, {300 + up, 239 - up, 3, 1}, 90);
    detector->begin(sequence_of(640, 480));
    EXPECT_THAT(detector->detect({0, 0, &picture, true, {}}), testing::IsEmpty()) << height;
  }
}

TEST(CloseMinusOpen, DoesNotRespondToEdgesAndLines) {
  const auto detector = make_classical("cmo");
  for (const double slope : {0.0, 0.2, 0.7}) {
    image::Picture picture = image::make_picture(640, 480, {image::Chroma::kNone});
    for (int y = 0; y < 480; ++y)
      for (int x = 0; x < 640; ++x) {
        const double below = y - 200 - slope * x;  // a horizon, and a road
        picture.planes[0].row(y)[x] = static_cast<std::uint8_t>(below < 0                   ? 180
                                                                : std::abs(below - 150) < 3 ? 160
                                                                                            : 90);
      }
    detector->begin(sequence_of(640, 480));
    EXPECT_THAT(detector->detect({0, 0, &picture, {}}), testing::IsEmpty()) << slope;
  }
}

// A picture whose sides are no multiples of the blocks is looked at up to its rim.
TEST(Classical, SeesAnObjectAtEachRim) {
  constexpr int kColumns = 166, kRows = 122;
  std::mt19937 random(8);
  std::normal_distribution<double> noise(0, 1.5);
  for (const char* name : {"cmo", "cmo-hmm"})
    for (const Pixel& centre :
         {Pixel(162.5, 60.5), Pixel(3.5, 60.5), Pixel(80.5, 118.5), Pixel(80.5, 3.5)}) {
      const auto detector = make_classical(name);
      detector->begin(sequence_of(kColumns, kRows));
      int frames_seen = 0;
      for (int frame = 0; frame < 30; ++frame) {
        image::Picture picture = image::make_picture(kColumns, kRows, {image::Chroma::kNone});
        for (int y = 0; y < kRows; ++y)
          for (int x = 0; x < kColumns; ++x) {
            const bool inside = (Pixel(x + 0.5, y + 0.5) - centre).norm() < 2.5;
            picture.planes[0].row(y)[x] =
                static_cast<std::uint8_t>(std::lround(150 - (inside ? 40 : 0) + noise(random)));
          }
        const auto found = detector->detect({frame, frame / 30.0, &picture, frame == 0, {}});
        frames_seen += std::any_of(
            found.begin(), found.end(), [&](const auto& one) { return hits(one, centre, 5); });
      }
      EXPECT_GE(frames_seen, 25) << name << " at " << centre.transpose();
    }
}

TEST(Classical, SeldomSeesAnythingInNoise) {
  for (const char* name : {"cmo", "cmo-hmm", "frame-difference"})
    EXPECT_LT(score_of(name, 0, 0.5, 0, 5).false_alarms, 0.1) << name;
}

TEST(FrameDifference, SeesWhatMovesAgainstTheTurnedPicture) {
  EXPECT_GT(score_of("frame-difference", -80, 0.2).hit, 0.7);
}

// A second sequence must not know of the first.
TEST(Classical, ForgetsTheSequenceBefore) {
  for (const std::string& name : classical_names()) {
    const auto detector = make_classical(name);
    std::vector<std::vector<results::Detection>> first;
    for (int time = 0; time < 2; ++time) {
      Flight flight(-15, 2, 0.3, 9);
      detector->begin(flight.sequence());
      for (std::size_t k = 0; k < 12; ++k) {
        const auto found = detector->detect(flight.next());
        if (time == 0)
          first.push_back(found);
        else
          EXPECT_EQ(found, first[k]) << name << " " << k;
      }
    }
  }
}

// Blank, tiny and odd pictures are answered, not fallen over.
TEST(Classical, TakesAnyPicture) {
  for (const std::string& name : classical_names())
    for (const auto& [width, height] :
         {std::pair{1, 1}, {3, 200}, {16, 16}, {21, 21}, {37, 53}, {1281, 33}, {640, 479}}) {
      const auto detector = make_classical(name);
      detector->begin(sequence_of(width, height));
      std::mt19937 random(1);
      for (int k = 0; k < 3; ++k) {
        const image::Picture picture = sky({}, k == 1 ? 0 : 3, random, width, height);
        const std::optional<detector::CameraTurn> turn =
            k > 0 ? std::optional(detector::CameraTurn{}) : std::nullopt;
        EXPECT_NO_THROW(detector->detect({k, k / 30.0, &picture, k == 0, turn}))
            << name << " " << width << "x" << height;
      }
    }
}

}  // namespace
}  // namespace airtruth::classical
