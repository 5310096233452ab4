// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include <opencv2/core.hpp>

#include "camera/lens/lens.h"
#include "camera/motion/motion.h"

// The two models of motion behind Estimator.
namespace airtruth::motion {

// The largest reprojection error of an inlier.
constexpr double kInlierPx = 1;
// A frame with fewer inliers is not measured.
constexpr int kMinInliers = 12;

// The number of consecutive bridged frames after which tracking starts anew: half a second of a
// video of 30 frames/s. Chosen by judgement. Twice as many find corners again after a longer gap,
// and leave a changed scene unmeasured for a second.
constexpr int kPatience = 15;

// The share of corners that are found again between two textured frames of one scene. With a
// smaller share, the scene has changed. Chosen by judgement. Doubled, a blurred frame of a fast
// turn counts as a cut.
constexpr double kCutShare = 0.12;

// The share of the previous frame's corners whose motion must fit across a cut of the picture. With
// this share or more, the frame is not a cut. Half: what covers less of the view than the scene
// does is an object.
constexpr double kFollowedShare = 0.5;

// The decision about a frame that could not be measured.
struct CornerLoss {
  bool is_cut = false;
  bool starts_anew = false;
};
// `before` is the number of corners tracked from the previous frame, `survivors` the number of them
// that were found again, and `fresh` the number of corners of the frame itself. `begins_shot` is as
// in Estimator::next().
inline CornerLoss corner_loss(std::size_t fresh,
                              std::size_t before,
                              std::size_t survivors,
                              int bridged_in_row,
                              bool begins_shot) {
  constexpr std::size_t fewest = kMinInliers;
  const bool textured = fresh >= 2 * fewest && before >= 2 * fewest;
  const bool cut = begins_shot || (textured && static_cast<double>(survivors) <
                                                   kCutShare * static_cast<double>(before));
  return {cut, cut || bridged_in_row >= kPatience || before < fewest};
}

// Whether a frame continues the one before it, from the number of corners that were tracked.
inline bool is_followed(bool begins_shot, int inliers, std::size_t before) {
  return !begins_shot || inliers >= kFollowedShare * static_cast<double>(before);
}

class Follower {
 public:
  virtual ~Follower() = default;
  virtual FrameMotion next(const cv::Mat& grey, bool damaged, bool begins_shot) = 0;
  // Sets the up direction as a unit vector in the reference camera; empty where no horizon is
  // known. Points below the horizon are near and have less weight (rotation_fit.h). The model
  // homography ignores the direction.
  virtual void set_up(const std::optional<Vector3>&) {}
  // The standard deviation of the error that the rotation gained since the frame before. It gains
  // error where a key frame is linked to others, and where tracking starts anew.
  virtual double stray_rad() const { return 0; }
};

// The model homography (planar.cpp) and the model rotation (spherical.cpp), with the seed of
// RANSAC's random samples.
std::unique_ptr<Follower> planar_follower(const cv::Mat& allowed);
std::unique_ptr<Follower> spherical_follower(const lens::Lens& lens,
                                             const cv::Mat& allowed,
                                             std::uint64_t seed);

}  // namespace airtruth::motion
