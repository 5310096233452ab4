// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>

#include <opencv2/core.hpp>

#include "camera/lens/lens.h"
#include "camera/motion/motion.h"

// The two models of motion behind Estimator.
namespace airtruth::motion {

constexpr int kPatience = 15;  // bridged frames in a row before tracking starts anew
constexpr double kCutShare =
    0.12;  // fewer survivors than this between two textured frames: the scene changed

constexpr double kFollowedShare =
    0.5;  // of the corners before: so many that fit across a cut of the picture say it is none

// What to do with a frame that could not be measured.
struct Loss {
  bool is_cut = false;
  bool starts_anew = false;
};
// before, survivors: corners followed from the frame before, and those that were found again;
// fresh: corners that the frame itself has. begins_shot: as Estimator::next().
inline Loss loss_of(std::size_t fresh,
                    std::size_t before,
                    std::size_t survivors,
                    int bridged_in_row,
                    int min_inliers,
                    bool begins_shot) {
  const auto fewest = static_cast<std::size_t>(min_inliers);
  const bool textured = fresh >= 2 * fewest && before >= 2 * fewest;
  const bool cut = begins_shot || (textured && static_cast<double>(survivors) <
                                                   kCutShare * static_cast<double>(before));
  return {cut, cut || bridged_in_row >= kPatience || before < fewest};
}

// Does a frame go on from the one before it, by what was followed of its corners?
inline bool is_followed(bool begins_shot, int inliers, std::size_t before) {
  return !begins_shot || inliers >= kFollowedShare * static_cast<double>(before);
}

class Follower {
 public:
  virtual ~Follower() = default;
  virtual FrameMotion next(const cv::Mat& grey, bool damaged, bool begins_shot) = 0;
  // Where up is, as a unit vector in the reference camera; empty where no horizon is known. What
  // lies under the horizon is near, and counts less (nearness.h). A homography does not ask.
  virtual void set_up(const std::optional<Vector3>&) {}
  // How far the rotation may have strayed from the truth since the frame before, as a standard
  // deviation: where a key frame was tied to others, and where tracking began anew.
  virtual double stray_rad() const { return 0; }
};

std::unique_ptr<Follower> planar_follower(const cv::Mat& allowed, const Options& options);
std::unique_ptr<Follower> spherical_follower(const lens::Lens& lens,
                                             const cv::Mat& allowed,
                                             const Options& options);

}  // namespace airtruth::motion
