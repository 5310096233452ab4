// SPDX-License-Identifier: Apache-2.0
#include "detection/classical/classical.h"

#include <array>
#include <cmath>
#include <random>

#include <airtruth/metrics.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "detection/classical/bearing_grid.h"
#include "detection/classical/blobs.h"
#include "detection/classical/filter_bank.h"
#include "detection/classical/free_view.h"
#include "detection/classical/kinds.h"
#include "detection/classical/scale_space.h"
#include "detection/classical/turned.h"

namespace airtruth::detection {
namespace {

constexpr int kWidth = 320, kHeight = 240;

// An elliptic Gaussian blob, as of a blurred aircraft.
struct Target {
  Pixel centre_px{0, 0};
  double contrast = 0;  // grey levels at its middle; negative: darker
  Pixel sigma_px{1.3, 0.9};
};

// Normal numbers, drawn once: drawing them for every picture takes longer than all detectors.
const std::vector<float>& normal_numbers() {
  static const std::vector<float> numbers = [] {
    std::mt19937 random(1);
    std::normal_distribution<float> normal(0, 1);
    std::vector<float> all(1'000'003);
    for (float& number : all) number = normal(random);
    return all;
  }();
  return numbers;
}

// A sky of 120 grey levels that rises downwards, with white noise.
image::Picture sky(const std::vector<Target>& targets,
                   double noise,
                   std::mt19937& random,
                   int width = kWidth,
                   int height = kHeight) {
  image::Picture picture = image::make_picture(width, height, {image::Chroma::kNone});
  const std::vector<float>& normal = normal_numbers();
  std::size_t next = random() % normal.size();
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      double value = 120 + 0.05 * y + noise * normal[next];
      if (++next == normal.size()) next = 0;
      for (const Target& target : targets) {
        const double u = (x + 0.5 - target.centre_px.x()) / target.sigma_px.x();
        const double v = (y + 0.5 - target.centre_px.y()) / target.sigma_px.y();
        if (std::abs(u) > 6 || std::abs(v) > 6) continue;
        value += target.contrast * std::exp(-0.5 * (u * u + v * v));
      }
      picture.planes[0].row(y)[x] =
          static_cast<std::uint8_t>(std::clamp(std::lround(value), 0L, 255L));
    }
  return picture;
}

SequenceInput sequence_of(int width = kWidth, int height = kHeight) {
  return {"test", width, height, 30, lens::pinhole_from_vertical_fov(45, {width, height})};
}

bool hits(const Detection& detection, const Pixel& centre, double within_px = 3) {
  const Box& box = detection.box_px;
  return std::hypot(box.x + box.width / 2 - centre.x(), box.y + box.height / 2 - centre.y()) <=
         within_px;
}

// A target that moves slowly over the sky as a shaking, turning camera sees it.
class Flight {
 public:
  Flight(double contrast, double noise, double turn_deg, std::uint32_t seed = 1)
      : contrast_(contrast), noise_(noise), turn_deg_(turn_deg), random_(seed) {}

  // The next frame, with the turn that led to it.
  FrameInput next() {
    const Quaternion cam_from_world = attitude();
    FrameInput frame;
    frame.index = index_;
    frame.time_s = static_cast<double>(index_) / 30;
    if (index_ > 0) frame.turn = CameraTurn{cam_from_world * before_.conjugate(), 0.02};
    before_ = cam_from_world;
    // Where a still camera would see it: 0.55 and 0.30 px a frame.
    const double k = static_cast<double>(index_);
    const Pixel still(100.3 + 0.55 * k, 90.7 + 0.30 * k);
    const auto seen = pixel_after_turn(sequence_.lens, cam_from_world, still);
    target_px_ = seen.value_or(Pixel(-100, -100));
    picture_ = sky({{target_px_, contrast_}}, noise_, random_);
    frame.picture = &picture_;
    ++index_;
    return frame;
  }
  const Pixel& target_px() const { return target_px_; }
  const SequenceInput& sequence() const { return sequence_; }

 private:
  // A steady turn with a shake of some pixels.
  Quaternion attitude() const {
    const double k = static_cast<double>(index_);
    const double yaw = radians(turn_deg_ * (0.1 * k + std::sin(1.7 * k)));
    const double pitch = radians(turn_deg_ * std::sin(1.1 * k));
    const double roll = radians(turn_deg_ * std::sin(0.3 * k));
    return Quaternion(Eigen::AngleAxisd(roll, Vector3::UnitZ()) *
                      Eigen::AngleAxisd(pitch, Vector3::UnitX()) *
                      Eigen::AngleAxisd(-yaw, Vector3::UnitY()));
  }

  double contrast_, noise_, turn_deg_;
  std::mt19937 random_;
  SequenceInput sequence_ = sequence_of();
  std::int64_t index_ = 0;
  Quaternion before_ = Quaternion::Identity();
  Pixel target_px_{0, 0};
  image::Picture picture_;
};

struct Score {
  double hit = 0;           // share of frames whose strongest detection is the target
  double false_alarms = 0;  // a frame, of at least `least`
  double mean_score = 0;    // of the hits
};

// Over the frames 20 to 79, as in the table of docs/detection.md.
Score score_of(
    const char* name, double contrast, double turn_deg, double least = 0, std::uint32_t seed = 1) {
  const auto detector = make_classical(name);
  Flight flight(contrast, 2, turn_deg, seed);
  detector->begin(flight.sequence());
  Score score;
  for (int k = 0; k < 80; ++k) {
    const FrameInput frame = flight.next();
    const auto detections = detector->detect(frame);
    if (k < 20) continue;
    const bool is_hit = !detections.empty() && hits(detections.front(), flight.target_px());
    score.hit += is_hit ? 1.0 / 60 : 0;
    if (is_hit) score.mean_score += detections.front().score;
    for (const Detection& detection : detections)
      if (!hits(detection, flight.target_px(), 8) && detection.score >= least)
        score.false_alarms += 1.0 / 60;
  }
  score.mean_score /= std::max(1.0, std::round(score.hit * 60));
  return score;
}

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
      EXPECT_EQ(blob->is_dark, contrast < 0);
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

// The same thing stands out less where there are others like it.
TEST(Blob, StandsOutLessAmongOthers) {
  std::mt19937 random(2);
  std::vector<Target> targets = {{{160.5, 120.5}, -40}};
  const auto alone = blob_at(scale_space(sky(targets, 2, random)), 0, {160, 120});
  for (int y = 30; y < kHeight; y += 40)
    for (int x = 25; x < kWidth; x += 40)
      if (std::hypot(x - 160, y - 120) > 30) targets.push_back({{x + 0.5, y + 0.5}, -40});
  const auto among = blob_at(scale_space(sky(targets, 2, random)), 0, {160, 120});
  ASSERT_TRUE(alone && among);
  EXPECT_LT(among->contrast_to_noise, 0.5 * alone->contrast_to_noise);
  EXPECT_GT(among->contrast_to_noise, kLeastContrastToNoise);
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

// A dark wheel and a wing with a gap in it, and a target beyond them.
image::Picture with_own_aircraft(const Pixel& target, image::Mask& mask, std::mt19937& random) {
  image::Picture picture = sky({{target, -40}}, 2, random);
  mask = {kWidth, kHeight, std::vector<unsigned char>(kWidth * kHeight, 255)};
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const bool is_wheel = std::hypot(x - 80, y - 200) < 9;
      const bool is_wing = y > 150 && y < 162 && (x < 120 || x > 128);
      if (!is_wheel && !is_wing) continue;
      picture.planes[0].row(y)[x] = is_wheel ? 20 : 240;
      mask.free[static_cast<std::size_t>(y * kWidth + x)] = 0;
    }
  return picture;
}

TEST(Classical, SeesNothingOnTheOwnAircraft) {
  for (const std::string& name : classical_names()) {
    std::array<int, 2> on_own{}, on_target{};
    for (const bool is_masked : {false, true}) {
      const auto detector = make_classical(name);
      SequenceInput sequence = sequence_of();
      std::mt19937 random(6);
      for (int k = 0; k < 15; ++k) {
        const Pixel target(200 + 0.5 * k, 60);
        image::Mask mask;
        const image::Picture picture = with_own_aircraft(target, mask, random);
        if (is_masked) sequence.own_aircraft = std::make_shared<image::Mask>(mask);
        if (k == 0) detector->begin(sequence);
        // The camera turns: the own aircraft stays where it is, and so differs from the turned
        // picture before.
        const Quaternion turn(
            Eigen::AngleAxisd(radians(k % 2 == 0 ? 1.0 : -1.0), Vector3::UnitY()));
        const auto camera = k > 0 ? std::optional(CameraTurn{turn, 0.02}) : std::nullopt;
        for (const Detection& one : detector->detect({k, k / 30.0, &picture, k == 0, camera})) {
          const Box& box = one.box_px;
          const int x = std::clamp(static_cast<int>(box.x + box.width / 2), 0, kWidth - 1);
          const int y = std::clamp(static_cast<int>(box.y + box.height / 2), 0, kHeight - 1);
          on_own[is_masked] += mask.is_free(x, y) && std::hypot(x - 80, y - 200) > 15 ? 0 : 1;
          on_target[is_masked] += hits(one, target, 6) ? 1 : 0;
        }
      }
    }
    EXPECT_GT(on_own[0], 0) << name;
    EXPECT_EQ(on_own[1], 0) << name;
    EXPECT_GE(on_target[1], on_target[0]) << name;
  }
}

TEST(FreeView, ReplacesTheOwnAircraftByWhatIsAround) {
  std::mt19937 random(8);
  image::Mask mask;
  const image::Picture picture = with_own_aircraft({250, 40}, mask, random);
  const FreeView view(&mask);
  const cv::Mat luma = view.luma(picture);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      if (mask.is_free(x, y)) continue;
      EXPECT_TRUE(view.hides({x + 0.5, y + 0.5}));
      EXPECT_NEAR(luma.at<std::uint8_t>(y, x), 120 + 0.05 * y, 6) << x << "," << y;
    }
  EXPECT_FALSE(view.hides({200.5, 60.5}));
  EXPECT_EQ(luma.at<std::uint8_t>(60, 200), picture.planes[0].row(60)[200]);
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

// The table of docs/detection.md: at a contrast of 2.5 times the noise of a pixel, single frames
// find the target in some frames and track before detect finds it in nearly all, with a camera that
// stands and with one that turns and shakes by up to 4 px a frame.
TEST(HiddenMarkov, FindsWhatSingleFramesDoNot) {
  for (const double turn_deg : {0.0, 0.5}) {
    EXPECT_LT(score_of("cmo", -5, turn_deg).hit, 0.5) << turn_deg;
    EXPECT_GT(score_of("cmo-hmm", -5, turn_deg).hit, 0.85) << turn_deg;
    EXPECT_GT(score_of("cmo-hmm", 20, turn_deg).hit, 0.9) << turn_deg;
    EXPECT_GT(score_of("cmo", 20, turn_deg).hit, 0.9) << turn_deg;
  }
}

TEST(HiddenMarkov, IsLostWithoutTheCamerasTurn) {
  const auto detector = make_classical("cmo-hmm");
  Flight flight(-5, 2, 0.5);
  detector->begin(flight.sequence());
  int hit = 0;
  for (int k = 0; k < 80; ++k) {
    FrameInput frame = flight.next();
    frame.turn = CameraTurn{};  // as if the camera stood still
    const auto found = detector->detect(frame);
    hit += k >= 20 && !found.empty() && hits(found.front(), flight.target_px()) ? 1 : 0;
  }
  EXPECT_LT(hit, 20);
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
    std::vector<std::vector<Detection>> first;
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
        const std::optional<CameraTurn> turn = k > 0 ? std::optional(CameraTurn{}) : std::nullopt;
        EXPECT_NO_THROW(detector->detect({k, k / 30.0, &picture, k == 0, turn}))
            << name << " " << width << "x" << height;
      }
    }
}

// Where the grid says a cell is seen, against a chain of single turns through the lens.
TEST(BearingGrid, KeepsACellsBearing) {
  const lens::Lens lens = lens::fisheye_from_vertical_fov(120, {640, 480});
  BearingGrid grid(lens, 2);
  const Quaternion step(Eigen::AngleAxisd(radians(0.3), Vector3(0.2, 1, 0.5).normalized()));
  const cv::Point cell{100, 60};
  Pixel expected = *grid.pixel_of(cell);
  EXPECT_NEAR(expected.x(), 201, 1e-6);
  bool was_anchored_anew = false;
  for (int k = 0; k < 12 && !was_anchored_anew; ++k) {
    was_anchored_anew = !grid.turn(step).empty();
    if (was_anchored_anew) break;
    expected = *pixel_after_turn(lens, step, expected);
    EXPECT_LT((*grid.pixel_of(cell) - expected).norm(), 1e-6);
    // A bright sample where the camera has the bearing is seen by the cell.
    cv::Mat samples(grid.size(), CV_8U, cv::Scalar(0));
    samples.at<std::uint8_t>(static_cast<int>(expected.y() / 2),
                             static_cast<int>(expected.x() / 2)) = 255;
    const cv::Mat seen = grid.seen_by_cells(samples);
    EXPECT_GT(cv::countNonZero(seen({cell.x - 1, cell.y - 1, 3, 3})), 0) << k;
  }
  EXPECT_TRUE(was_anchored_anew);
}

TEST(FilterBank, ForgetsAndFollows) {
  // A constant ratio leads to its limit.
  FilterBank bank({64, 48});
  const cv::Mat ratio(48, 64, CV_32F, cv::Scalar(3));
  for (int k = 0; k < 200; ++k) bank.update(ratio);
  // The fixed point of l = ln 3 + kRemembers (l + ln kStays), but for the error of the power.
  const double limit = (std::log(3) + FilterBank::kRemembers * std::log(FilterBank::kStays)) /
                       (1 - FilterBank::kRemembers);
  EXPECT_NEAR(std::log(bank.odds().at<float>(24, 32)), limit, 0.06 * limit);
  // Odds follow a target that moves along a filter's diagonal, one cell a frame.
  FilterBank other({64, 48});
  for (int k = 0; k < 20; ++k) {
    cv::Mat now(48, 64, CV_32F, cv::Scalar(0.5));
    now.at<float>(10 + k, 20 + k) = 50;
    other.update(now);
  }
  cv::Point at;
  cv::minMaxLoc(other.odds(), nullptr, nullptr, nullptr, &at);
  EXPECT_EQ(at, cv::Point(39, 29));
}

}  // namespace
}  // namespace airtruth::detection
