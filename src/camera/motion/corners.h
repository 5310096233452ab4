// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include <opencv2/core.hpp>

#include "camera/motion/patch.h"
#include "foundation/image/layer.h"

// Selects corners and tracks them from one picture to another, for both models of motion. All
// positions are OpenCV's integer-centred pixels.
namespace airtruth::motion {

using Pyramid = std::vector<cv::Mat>;

Pyramid pyramid_of(const cv::Mat& grey);

// A mask that is 255 where corners are allowed, which is at a distance from the own aircraft.
cv::Mat allowed_area(int width, int height, const image::Mask* own_aircraft);

// The strongest corners of each cell of the picture, so that no single cloud receives all corners.
// Where is_far is given, up to half of the corners are far ones. Far corners may lie closer
// together, because the strip along the horizon has few cells.
std::vector<cv::Point2f> spread_corners(const cv::Mat& grey,
                                        const cv::Mat& allowed,
                                        const std::function<bool(const cv::Point2f&)>& is_far = {});

// Corners where their tracks begin, and their places in a later picture.
struct Tracks {
  std::vector<cv::Point2f> begun, now;
};
// The tracks from the picture `from` on to the picture `to`, by pyramidal Lucas-Kanade, which
// tracks them back as a check. A track ends where the corner was not found inside the allowed area,
// or did not return to its place.
Tracks followed(const Pyramid& from,
                const Pyramid& to,
                const cv::Mat& allowed,
                const Tracks& tracks);

// The positions of a corner in two frames, in pixels of the picture (corner origin).
struct Step {
  Pixel from, to;
};

// The number of corners that are followed from one frame to the next: it bounds the time.
constexpr std::size_t kMaxSteps = 150;

// The corners of one frame, to be found in the next. Where most of the picture moves as one, few
// corners on coarse levels tell where all are to be looked for; otherwise each one is followed by
// itself.
class Steps {
 public:
  // The corners to follow from now on, by their positions in this frame; at most kMaxSteps of them.
  void take(const Levels& levels, const std::vector<Pixel>& positions);
  std::size_t size() const { return corners_.size(); }

  // Few of the corners, from the coarsest level to the one whose pixels are good enough for a
  // guess.
  std::vector<Step> coarse(const Levels& now) const;
  // All corners on the finest level, each from a guess of its position, which may be empty.
  using Guess = std::function<std::optional<Pixel>(const Pixel&)>;
  std::vector<Step> fine(const Levels& now, const Guess& guess) const;
  // All corners, each by itself through the whole pyramid and back, which costs several
  // times as much and holds where half of the picture moves by itself.
  std::vector<Step> alone(const Levels& now, const cv::Mat& allowed) const;

 private:
  std::optional<Step> follow(const Pixel& from, const Levels& now, int finest) const;

  Levels levels_;                    // of the corners' frame
  std::vector<LevelPatch> corners_;  // on the finest level
};

}  // namespace airtruth::motion
