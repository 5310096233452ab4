// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include <opencv2/core.hpp>

#include "lens/lens.h"
#include "motion/motion.h"

// The two models of motion behind Estimator.
namespace airtruth::motion {

constexpr int kPatience = 15;  // bridged frames in a row before tracking starts anew
constexpr double kCutShare =
    0.12;  // fewer survivors than this between two textured frames: the scene changed

// What to do with a frame that could not be measured.
struct Loss {
  bool is_cut = false;
  bool starts_anew = false;
};
// before, survivors: corners followed from the frame before, and those that were found again;
// fresh: corners that the frame itself has.
inline Loss loss_of(std::size_t fresh,
                    std::size_t before,
                    std::size_t survivors,
                    int bridged_in_row,
                    int min_inliers) {
  const auto fewest = static_cast<std::size_t>(min_inliers);
  const bool textured = fresh >= 2 * fewest && before >= 2 * fewest;
  const bool cut =
      textured && static_cast<double>(survivors) < kCutShare * static_cast<double>(before);
  return {cut, cut || bridged_in_row >= kPatience || before < fewest};
}

class Follower {
 public:
  virtual ~Follower() = default;
  virtual FrameMotion next(const cv::Mat& grey, bool damaged) = 0;
  // How far the rotation may have strayed from the truth since the frame before, as a standard
  // deviation: where a key frame was tied to others, and where tracking began anew.
  virtual double stray_rad() const { return 0; }
};

std::unique_ptr<Follower> planar_follower(const cv::Mat& allowed, const Options& options);
std::unique_ptr<Follower> spherical_follower(const lens::Lens& lens,
                                             const cv::Mat& allowed,
                                             const Options& options);

}  // namespace airtruth::motion
