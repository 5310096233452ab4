// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <deque>

#include "runners/classical/bearing_grid.h"
#include "runners/classical/blobs.h"
#include "runners/classical/classical.h"

namespace airtruth::classical {
namespace {

// Where a constant of this file states no origin, it is a choice; docs/detection.md has the result.

// Frames before the present one in which an object is looked for at the same bearing.
constexpr std::size_t kFramesBefore = 2;
// It may have moved by this many samples of its level a frame.
constexpr int kMovePerFrame = 2;

struct FrameBefore {
  std::vector<Level> levels;
  // Carries a direction in this camera into the next frame's.
  Quaternion next_from_this;
};

class CloseMinusOpen : public ClassicalDetector {
 public:
  void begin(const detector::SequenceInput& sequence) override {
    ClassicalDetector::begin(sequence);
    before_.clear();
    // Each level has a quarter of the samples of the one below.
    const double samples = 4.0 / 3 * sequence.width * sequence.height;
    confident_ = confident_deviations(samples, sequence.frame_rate_hz);
  }

  std::vector<results::Detection> detect(const detector::FrameInput& frame) override {
    if (frame.turn && !before_.empty())
      before_.front().next_from_this = frame.turn->this_from_previous;
    else
      before_.clear();
    std::vector<Level> levels = scale_space(*frame.picture, view_);
    std::vector<Blob> blobs = blobs_of(levels, {});
    for (Blob& blob : blobs) blob.contrast_to_noise *= persistence(blob, levels[blob.level]);
    before_.push_front({std::move(levels), Quaternion::Identity()});
    if (before_.size() > kFramesBefore) before_.pop_back();
    return detections_of(std::move(blobs), kLeastContrastToNoise);
  }

 private:
  // The mean, over this frame and those before, of the response at the blob's bearing relative to
  // that of this frame (at most 1): what the noise made, and what stays in place on the lens while
  // the camera turns, is not there in the other frames.
  double persistence(const Blob& blob, const Level& level) const {
    const double here = level.relative_response(blob.sample);
    double sum = 1;
    int count = 1;
    Quaternion before_from_this = Quaternion::Identity();
    const Pixel pixel = level.pixel_of(blob.sample.x, blob.sample.y);
    int radius = 0;
    for (const FrameBefore& before : before_) {
      before_from_this = before.next_from_this.conjugate() * before_from_this;
      radius += kMovePerFrame;
      const auto there = pixel_after_turn(*lens_, before_from_this, pixel);
      if (!there || blob.level >= before.levels.size()) break;
      const Level& other = before.levels[blob.level];
      const cv::Point sample = other.sample_at(*there);
      if (!cv::Rect({}, other.picture.size()).contains(sample)) break;
      const double response = other.relative_response(other.strongest_near(sample, radius));
      sum += std::min(1.0, response / std::max(here, 1e-9));
      ++count;
    }
    return sum / count;
  }

  std::deque<FrameBefore> before_;  // the latest first
};

}  // namespace

std::unique_ptr<detector::Detector> make_close_minus_open() {
  return std::make_unique<CloseMinusOpen>();
}

}  // namespace airtruth::classical
