// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "runners/classical/bearing_grid.h"
#include "runners/classical/classical.h"

// Skies with targets, and flights past them, for the tests of the classical detectors, in whose
// namespace they are.
namespace airtruth::classical {

inline constexpr int kWidth = 320, kHeight = 240;

// An elliptic Gaussian blob, as of a blurred aircraft.
struct Target {
  Pixel centre_px{0, 0};
  double contrast = 0;  // grey levels at its middle; negative: darker
  Pixel sigma_px{1.3, 0.9};
};

// Normal numbers, drawn once: drawing them for every picture takes longer than all detectors.
inline const std::vector<float>& normal_numbers() {
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
inline image::Picture sky(const std::vector<Target>& targets,
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

inline detector::SequenceInput sequence_of(int width = kWidth, int height = kHeight) {
  return {"test", width, height, 30, lens::pinhole_from_vertical_fov(45, {width, height})};
}

inline bool hits(const results::Detection& detection, const Pixel& centre, double within_px = 3) {
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
  detector::FrameInput next() {
    const Quaternion cam_from_world = attitude();
    detector::FrameInput frame;
    frame.index = index_;
    frame.time_s = static_cast<double>(index_) / 30;
    if (index_ > 0) frame.turn = detector::CameraTurn{cam_from_world * before_.conjugate(), 0.02};
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
  const detector::SequenceInput& sequence() const { return sequence_; }

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
  detector::SequenceInput sequence_ = sequence_of();
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
inline Score score_of(
    const char* name, double contrast, double turn_deg, double least = 0, std::uint32_t seed = 1) {
  const auto detector = make_classical(name);
  Flight flight(contrast, 2, turn_deg, seed);
  detector->begin(flight.sequence());
  Score score;
  for (int k = 0; k < 80; ++k) {
    const detector::FrameInput frame = flight.next();
    const auto detections = detector->detect(frame);
    if (k < 20) continue;
    const bool is_hit = !detections.empty() && hits(detections.front(), flight.target_px());
    score.hit += is_hit ? 1.0 / 60 : 0;
    if (is_hit) score.mean_score += detections.front().score;
    for (const results::Detection& detection : detections)
      if (!hits(detection, flight.target_px(), 8) && detection.score >= least)
        score.false_alarms += 1.0 / 60;
  }
  score.mean_score /= std::max(1.0, std::round(score.hit * 60));
  return score;
}

}  // namespace airtruth::classical
