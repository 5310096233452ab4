// SPDX-License-Identifier: Apache-2.0
#include "camera/motion/corners.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "camera/opencv_plugin/opencv_plugin.h"
#include "foundation/image/mats.h"

namespace airtruth::motion {
namespace {

// The pyramid levels above the picture itself. On the coarsest, half
// a window is 6 samples of 16 px, which bounds the motion between two frames to some 100 px. Twice
// as many would make levels that are smaller than a window.
constexpr int kPyramidLevels = 4;
// The pyramid levels for tracking back, which starts at the corner's original position.
constexpr int kBackLevels = 1;
// The side of the window around a corner, px. Chosen by judgement. Twice as wide, it takes four
// times as long, and more windows hold both far and near objects, which move differently.
constexpr int kWindowPx = 13;
// The largest number of corners of a picture.
constexpr int kMaxCorners = 320;
// The largest distance between a corner and its position after tracking forth and back.
constexpr double kForthAndBackPx = 0.5;
// Corners are spread over kGrid x kGrid cells. Chosen by judgement: with 16, a cell keeps two of
// the corners, and the weak ones of cells without texture displace strong ones.
constexpr int kGrid = 8;
// The least distance of a corner from the own aircraft, px by row and by column: half a window, and
// 3 px for an outline that is soft. Twice as much loses what is between parts of the own aircraft.
constexpr int kMaskMarginPx = 9;
// The limit on far corners per cell, as a multiple of the limit on other corners. Chosen by
// judgement: the strip along the horizon has some 16 of the 64 cells, and half of the corners.
constexpr int kFarInCell = 3;

}  // namespace

Pyramid pyramid_of(const cv::Mat& grey) {
  Pyramid pyramid;
  opencv_plugin::functions().build_optical_flow_pyramid(grey,
                                                        pyramid,
                                                        cv::Size(kWindowPx, kWindowPx),
                                                        kPyramidLevels,
                                                        true,
                                                        cv::BORDER_REFLECT_101,
                                                        cv::BORDER_CONSTANT,
                                                        true);
  return pyramid;
}

cv::Mat allowed_area(int width, int height, const image::Mask* own_aircraft) {
  cv::Mat allowed(height, width, CV_8UC1, cv::Scalar(255));
  if (own_aircraft == nullptr) return allowed;
  cv::erode(
      image::mat_of(*own_aircraft),
      allowed,
      cv::getStructuringElement(cv::MORPH_RECT, {2 * kMaskMarginPx + 1, 2 * kMaskMarginPx + 1}));
  return allowed;
}

namespace {

// Corners in pixels of `grey`, strongest first. They are searched at half size, which is four times
// faster. The position need not be exact, since Lucas-Kanade tracks the surroundings of any point.
std::vector<cv::Point2f> strongest_corners(const cv::Mat& grey,
                                           const cv::Mat& allowed,
                                           double distance_px) {
  const bool half = std::min(grey.cols, grey.rows) >= 400;
  cv::Mat image = grey;
  cv::Mat mask = allowed;
  if (half) {
    cv::resize(grey, image, {}, 0.5, 0.5, cv::INTER_AREA);
    cv::resize(allowed, mask, image.size(), 0, 0, cv::INTER_NEAREST);
  }
  const double scale = half ? 2.0 : 1.0;
  std::vector<cv::Point2f> corners;
  cv::goodFeaturesToTrack(image, corners, 0, 0.0005, distance_px / scale, mask, 5);
  const auto s = static_cast<float>(scale);
  for (cv::Point2f& c : corners) c = {(c.x + 0.5f) * s - 0.5f, (c.y + 0.5f) * s - 0.5f};
  return corners;
}

// Adds the strongest corners to `chosen`: at most `in_cell` in each cell of a grid over the
// picture, and until `most` are chosen.
void choose(const std::vector<cv::Point2f>& strongest_first,
            const cv::Size& size,
            int in_cell,
            int most,
            std::vector<cv::Point2f>& chosen) {
  std::vector<int> taken(kGrid * kGrid, 0);
  for (const cv::Point2f& c : strongest_first) {
    const int column =
        std::min(kGrid - 1, static_cast<int>(c.x * kGrid / static_cast<float>(size.width)));
    const int row =
        std::min(kGrid - 1, static_cast<int>(c.y * kGrid / static_cast<float>(size.height)));
    int& count = taken[static_cast<std::size_t>(row * kGrid + column)];
    if (count >= in_cell || static_cast<int>(chosen.size()) >= most) continue;
    ++count;
    chosen.push_back(c);
  }
}

}  // namespace

std::vector<cv::Point2f> spread_corners(const cv::Mat& grey,
                                        const cv::Mat& allowed,
                                        const std::function<bool(const cv::Point2f&)>& is_far) {
  const double distance =
      std::max(6.0, std::sqrt(double(grey.cols) * grey.rows / kMaxCorners) * 0.35);
  std::vector<cv::Point2f> far, near;
  for (const cv::Point2f& corner : strongest_corners(grey, allowed, distance))
    (is_far && is_far(corner) ? far : near).push_back(corner);
  const int share = std::max(2, 5 * kMaxCorners / (4 * kGrid * kGrid));
  std::vector<cv::Point2f> chosen;
  choose(far, grey.size(), kFarInCell * share, kMaxCorners / 2, chosen);
  choose(near, grey.size(), share, kMaxCorners, chosen);
  return chosen;
}

namespace {

// Pyramidal Lucas-Kanade from `corners` to `moved`, with the guess that `moved` holds by a flag of
// OpenCV or from the corners' own places. Returns for each corner whether it was found.
std::vector<unsigned char> tracked(const Pyramid& from,
                                   const Pyramid& to,
                                   const std::vector<cv::Point2f>& corners,
                                   std::vector<cv::Point2f>& moved,
                                   int levels,
                                   int flags) {
  // The search for one corner ends after 10 rounds, or once it moves by less than 0.03 px.
  const cv::TermCriteria enough(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 10, 0.03);
  // Least eigenvalue of the normal matrix, OpenCV's default.
  constexpr double kMinEigenvalue = 1e-4;
  std::vector<unsigned char> found;
  std::vector<float> unused;
  opencv_plugin::functions().calc_optical_flow_pyr_lk(from,
                                                      to,
                                                      corners,
                                                      moved,
                                                      found,
                                                      unused,
                                                      {kWindowPx, kWindowPx},
                                                      levels,
                                                      enough,
                                                      flags,
                                                      kMinEigenvalue);
  return found;
}

}  // namespace

Tracks followed(const Pyramid& from,
                const Pyramid& to,
                const cv::Mat& allowed,
                const Tracks& tracks) {
  Tracks going_on;
  const std::vector<cv::Point2f>& corners = tracks.now;
  if (corners.empty()) return going_on;
  std::vector<cv::Point2f> moved, back = corners;
  const auto found = tracked(from, to, corners, moved, kPyramidLevels, 0);
  const auto found_back = tracked(to, from, moved, back, kBackLevels, cv::OPTFLOW_USE_INITIAL_FLOW);
  for (std::size_t i = 0; i < moved.size(); ++i) {
    const cv::Point2f& p = moved[i];
    const bool inside = p.x >= 0 && p.y >= 0 && p.x <= static_cast<float>(allowed.cols - 1) &&
                        p.y <= static_cast<float>(allowed.rows - 1);
    if (found[i] == 0 || found_back[i] == 0 || !inside) continue;
    if (cv::norm(back[i] - corners[i]) > kForthAndBackPx) continue;
    if (allowed.at<unsigned char>(static_cast<int>(p.y), static_cast<int>(p.x)) == 0) continue;
    going_on.begun.push_back(tracks.begun[i]), going_on.now.push_back(p);
  }
  return going_on;
}

namespace {

// The number of corners that coarse() follows. Both constants are chosen by judgement;
// docs/optimisations.md has what other methods cost.
constexpr std::size_t kFew = 64;
// The longer side of the level on which a guess ends, in samples. A search there is good to a tenth
// of a sample, and a search on the finest level reaches kPatchPx / 4 pixels.
constexpr int kMaxGuessSide = 512;

// `count` of `size` things, evenly spread.
std::size_t spread(std::size_t i, std::size_t count, std::size_t size) { return i * size / count; }

int guess_level(const Levels& levels) {
  const int coarsest = static_cast<int>(levels.size()) - 1;
  int level = std::min(1, coarsest);
  const auto side = [&](int l) {
    const cv::Mat& grey = levels[static_cast<std::size_t>(l)];
    return std::max(grey.cols, grey.rows);
  };
  while (level < coarsest && side(level) > kMaxGuessSide) ++level;
  return level;
}

}  // namespace

void Steps::take(const Levels& levels, const std::vector<Pixel>& positions) {
  cv::Mat finest = levels_.empty() ? cv::Mat() : levels_.front();
  levels.front().copyTo(finest);  // the samples of the picture will be gone
  levels_ = levels;
  levels_.front() = finest;
  corners_.clear();
  const std::size_t count = std::min(kMaxSteps, positions.size());
  for (std::size_t i = 0; i < count; ++i) {
    const Pixel& position = positions[spread(i, count, positions.size())];
    if (const auto patch = LevelPatch::around(levels, 0, position)) corners_.push_back(*patch);
  }
}

// Follows a corner from the coarsest level to `finest`. A level on which it is not found is left
// out, but for the last.
std::optional<Step> Steps::follow(const Pixel& from, const Levels& now, int finest) const {
  Pixel way(0, 0);
  bool is_found = false;
  for (int level = static_cast<int>(levels_.size()) - 1; level >= finest; --level) {
    const auto patch = LevelPatch::around(levels_, level, from);
    const auto at = patch ? patch->find(now, patch->middle() + way) : std::nullopt;
    is_found = at.has_value();
    if (is_found) way = *at - patch->middle();
  }
  if (!is_found) return std::nullopt;
  return Step{from, from + way};
}

std::vector<Step> Steps::coarse(const Levels& now) const {
  std::vector<Step> steps;
  const int finest = guess_level(levels_);
  const std::size_t count = std::min(kFew, corners_.size());
  for (std::size_t i = 0; i < count; ++i) {
    const LevelPatch& corner = corners_[spread(i, count, corners_.size())];
    if (const auto step = follow(corner.middle(), now, finest)) steps.push_back(*step);
  }
  return steps;
}

std::vector<Step> Steps::fine(const Levels& now, const Guess& guess) const {
  std::vector<Step> steps;
  for (const LevelPatch& corner : corners_)
    if (const auto near = guess(corner.middle()))
      if (const auto to = corner.find(now, *near)) steps.push_back({corner.middle(), *to});
  return steps;
}

std::vector<Step> Steps::alone(const Levels& now, const cv::Mat& allowed) const {
  // OpenCV's positions are those of the middles of samples; those of corners are whole numbers.
  constexpr float kHalf = 0.5f;
  std::vector<cv::Point2f> from;
  for (const LevelPatch& corner : corners_)
    from.emplace_back(static_cast<float>(corner.middle().x()) - kHalf,
                      static_cast<float>(corner.middle().y()) - kHalf);
  const auto& [begun, to] =
      followed(pyramid_of(levels_.front()), pyramid_of(now.front()), allowed, {from, from});
  std::vector<Step> steps;
  for (std::size_t i = 0; i < to.size(); ++i)
    steps.push_back(
        {Pixel(begun[i].x + kHalf, begun[i].y + kHalf), Pixel(to[i].x + kHalf, to[i].y + kHalf)});
  return steps;
}

}  // namespace airtruth::motion
