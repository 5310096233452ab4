// SPDX-License-Identifier: Apache-2.0
#include "runners/association/associator.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "evaluation/matching/assignment.h"
#include "foundation/base/error.h"
#include "foundation/geometry/box.h"

namespace airtruth::association {
namespace {

constexpr double kLeastSizePx = 1;  // a box counts as this wide and high at least

// A declared track ends when it has had no detection for longer than this. Chosen: ByteTrack's 30
// frames at 30 frames/s.
constexpr double kMostMissed_s = 1;
// Chi-square with 3 degrees of freedom stays below it with a probability of 0.99: the share of a
// target's own detections that the gate lets through.
constexpr double kGate = 11.344866730144359;
// Standard error of a box's centre: px, and as a share of the box's width or height; both add in
// squares. Chosen: a quarter of a pixel's rounding on each side of a box, and detectors' boxes that
// move by a tenth of their size from frame to frame.
constexpr double kCentreErrorPx = 0.5;
constexpr double kCentreErrorOfSize = 0.1;
// Standard error of a box's size as a share of it; the centre's error in px adds to it.
constexpr double kSizeError = 0.2;
// Standard deviation of the camera's turn about each axis where it is not known, rad/s. Chosen: a
// small aircraft rolls and yaws by some ten to twenty degrees in a second.
constexpr double kUnknownTurn_radps = 0.3;

[[noreturn]] void out_of_range(const std::string& what, double value, const std::string& expected) {
  throw Error(fmt::format("association: {} is {}; expected {}", what, value, expected));
}

}  // namespace

void validate(const AssociationOptions& options) {
  if (options.declare_n < 1 || options.declare_n > 1000) {
    out_of_range("N of M/N", options.declare_n, "1 to 1000");
  }
  if (options.declare_m < 1 || options.declare_m > options.declare_n) {
    out_of_range("M of M/N", options.declare_m, fmt::format("1 to {}", options.declare_n));
  }
  if (options.confident_score && !std::isfinite(*options.confident_score)) {
    out_of_range("the confident score", *options.confident_score, "a finite number");
  }
}

Associator::Associator(const AssociationOptions& options) : options_(options) { validate(options); }

void Associator::begin(const detector::SequenceInput& sequence) {
  lens_ = sequence.lens;
  tracks_.clear();
  declared_ = 0;
  const Pixel middle(sequence.width / 2.0, sequence.height / 2.0);
  const auto left = lens_->ray_from_pixel(middle - Pixel(0.5, 0));
  const auto right = lens_->ray_from_pixel(middle + Pixel(0.5, 0));
  rad_per_px_ = left && right ? (*right - *left).norm() : 0;
}

std::vector<results::Detection> Associator::step(const detector::FrameInput& frame,
                                                 std::vector<results::Detection> detections) {
  check(lens_.has_value(), "Associator::begin comes before step");
  for (results::Detection& detection : detections) detection.track.reset();
  predict(frame);
  std::vector<Seen> seen = seen_in(detections);
  match(detections, seen, true, true);
  match(detections, seen, true, false);
  match(detections, seen, false, true);
  begin_tracks(detections, seen);
  declare(detections);
  end_tracks();
  return detections;
}

void Associator::predict(const detector::FrameInput& frame) {
  if (frame.begins_shot) tracks_.clear();
  const double seconds = std::max(0.0, frame.time_s - time_s_);
  time_s_ = frame.time_s;
  const Quaternion turn = frame.turn ? frame.turn->this_from_previous : Quaternion::Identity();
  const double error_rad =
      frame.turn ? frame.turn->error_px * rad_per_px_ : kUnknownTurn_radps * seconds;
  for (Track& track : tracks_) {
    track.filter.predict(seconds, turn, error_rad);
    ++track.frames;
    track.detection.reset();
  }
}

std::optional<Sighting> Associator::sighting_of(const Box& box) const {
  const Pixel centre = centre_of(box);
  const auto ray = lens_->ray_from_pixel(centre);
  const auto left = lens_->ray_from_pixel(centre - Pixel(0.5, 0));
  const auto right = lens_->ray_from_pixel(centre + Pixel(0.5, 0));
  const auto above = lens_->ray_from_pixel(centre - Pixel(0, 0.5));
  const auto below = lens_->ray_from_pixel(centre + Pixel(0, 0.5));
  if (!ray || !left || !right || !above || !below) return std::nullopt;
  Eigen::Matrix<double, 3, 2> ray_from_px;
  ray_from_px.col(0) = *right - *left;
  ray_from_px.col(1) = *below - *above;
  const double width = std::max(box.width, kLeastSizePx);
  const double height = std::max(box.height, kLeastSizePx);
  const auto variance = [&](double length) {
    return std::pow(kCentreErrorPx, 2) + std::pow(kCentreErrorOfSize * length, 2);
  };
  Sighting sighting;
  sighting.ray_in_cam = *ray;
  sighting.ray_covariance = ray_from_px *
                            Eigen::Vector2d(variance(width), variance(height)).asDiagonal() *
                            ray_from_px.transpose();
  const double steradian_per_px2 = ray_from_px.col(0).cross(ray_from_px.col(1)).norm();
  sighting.log_size = std::log(width * height * steradian_per_px2) / 2;
  sighting.log_size_variance =
      kSizeError * kSizeError + kCentreErrorPx * kCentreErrorPx / (width * height);
  return sighting;
}

std::vector<Associator::Seen> Associator::seen_in(
    const std::vector<results::Detection>& detections) const {
  std::vector<Seen> seen;
  for (std::size_t i = 0; i < detections.size(); ++i) {
    const auto sighting = sighting_of(detections[i].box_px);
    if (!sighting) continue;
    const bool confident =
        !options_.confident_score || detections[i].score >= *options_.confident_score;
    seen.push_back({i, *sighting, confident});
  }
  return seen;
}

void Associator::match(const std::vector<results::Detection>& detections,
                       std::vector<Seen>& seen,
                       bool declared,
                       bool confident) {
  std::vector<matching::GatedPair> pairs;
  // The negative log likelihood of a miss: a detection within the gate is better than none, so
  // that as many tracks as possible have one.
  double alone = 0;
  for (std::size_t t = 0; t < tracks_.size(); ++t) {
    const Track& track = tracks_[t];
    if (track.number.has_value() != declared || track.detection) continue;
    for (std::size_t s = 0; s < seen.size(); ++s) {
      const results::Detection& detection = detections[seen[s].index];
      if (seen[s].confident != confident || seen[s].taken || detection.category != track.category ||
          !track.filter.is_near(seen[s].sighting, kGate)) {
        continue;
      }
      const auto comparison = track.filter.compare(seen[s].sighting);
      if (comparison.distance > kGate) continue;
      pairs.push_back({t, s, comparison.distance + comparison.log_determinant});
      const double least = kGate + comparison.log_determinant;
      alone = pairs.size() == 1 ? least : std::max(alone, least);
    }
  }
  const auto chosen = matching::least_cost_pairs(pairs, tracks_.size(), seen.size(), alone);
  for (std::size_t t = 0; t < tracks_.size(); ++t) {
    if (!chosen[t]) continue;
    Seen& one = seen[*chosen[t]];
    one.taken = true;
    Track& track = tracks_[t];
    track.detection = one.index;
    track.filter.update(one.sighting);
    track.seen_s = time_s_;
    if (confident) ++track.hits;
  }
}

void Associator::begin_tracks(const std::vector<results::Detection>& detections,
                              const std::vector<Seen>& seen) {
  for (const Seen& one : seen)
    if (one.confident && !one.taken)
      tracks_.push_back({.filter = DirectionFilter(one.sighting),
                         .category = detections[one.index].category,
                         .seen_s = time_s_,
                         .detection = one.index});
}

void Associator::declare(std::vector<results::Detection>& detections) {
  for (Track& track : tracks_) {
    if (!track.number && track.hits >= options_.declare_m) track.number = ++declared_;
    if (track.detection) detections[*track.detection].track = track.number;
  }
}

void Associator::end_tracks() {
  const int most_misses = options_.declare_n - options_.declare_m;
  std::erase_if(tracks_, [&](const Track& track) {
    return track.number ? time_s_ - track.seen_s > kMostMissed_s
                        : track.frames - track.hits > most_misses;
  });
}

}  // namespace airtruth::association
