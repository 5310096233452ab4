// SPDX-License-Identifier: Apache-2.0
#include "comparison/match/real.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <sstream>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <opencv2/imgproc.hpp>

#include "comparison/appearance/segment.h"
#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/base/median.h"
#include "foundation/base/text.h"
#include "picture/video/reader.h"

namespace airtruth::match {
namespace {

// Where a constant of this file states no origin, it is a choice.

// Least number of boxes in a shot.
constexpr std::size_t kMinBoxes = 5;
constexpr std::int64_t kNeighbours = 7;  // frames to either side whose sizes are looked at
constexpr double kMaxStray = 0.25;       // of a size from the median of those around it

double larger_side(const Box& box) { return std::max(box.width, box.height); }

// The shot with most boxes: [first, end) in frames.
std::pair<std::int64_t, std::int64_t> best_shot(const RealBoxes& boxes,
                                                const std::vector<std::int64_t>& cuts) {
  std::vector<std::int64_t> starts = {0};
  starts.insert(starts.end(), cuts.begin(), cuts.end());
  std::pair<std::int64_t, std::int64_t> best{0, 0};
  std::ptrdiff_t most = -1;
  for (std::size_t i = 0; i < starts.size(); ++i) {
    const std::int64_t end = i + 1 < starts.size() ? starts[i + 1] : INT64_MAX;
    const std::ptrdiff_t count =
        std::distance(boxes.lower_bound(starts[i]), boxes.lower_bound(end));
    if (count > most) most = count, best = {starts[i], end};
  }
  return best;
}

cv::Mat small_mask(const cv::Mat& mask) {
  const int larger = std::max(mask.cols, mask.rows);
  if (larger <= kMaxMaskPx) return mask;
  const double scale = double(kMaxMaskPx) / larger;
  cv::Mat small;
  cv::resize(mask,
             small,
             {std::max(1, static_cast<int>(mask.cols * scale)),
              std::max(1, static_cast<int>(mask.rows * scale))},
             0,
             0,
             cv::INTER_AREA);
  return small > 127;
}

// Keeps the boxes of the shot that has most of them.
void keep_best_shot(const fs::path& video, const Warn& warn_to, RealAircraft& found) {
  const auto [first, end] = best_shot(found.boxes, found.cuts);
  if (!found.cuts.empty())
    warn(warn_to,
         fmt::format("{}: the clip is cut at frame {}; only the shot from frame {} on is compared",
                     video.string(),
                     fmt::join(found.cuts, ", "),
                     first));
  found.boxes.erase(found.boxes.begin(), found.boxes.lower_bound(first));
  found.boxes.erase(found.boxes.lower_bound(end), found.boxes.end());
}

constexpr double kFarthestPx = 1e6;           // as far as a box may lie from the picture's corner
constexpr std::int64_t kLongest = 1'000'000;  // frames from the first box to the last: 9 h at 30/s

double pixels(const std::string& cell, const Where& where) {
  const double value = finite_number(cell, where);
  if (std::abs(value) > kFarthestPx)
    throw Error("'" + cell.substr(0, 40) + "' is no place in a picture; expected pixels within 1e6",
                where);
  return value;
}

}  // namespace

RealBoxes read_boxes(const fs::path& file, double origin_px) {
  std::istringstream lines{std::string(without_mark(read_file(file)))};
  std::string line;
  std::getline(lines, line);
  const std::vector<std::string> header = cells_of(line);
  const std::vector<std::string> expected = {"frame", "x", "y", "width", "height"};
  const std::vector<std::string> brief = {"frame", "x", "y", "w", "h"};
  if (header != expected && header != brief)
    throw Error("does not begin with frame,x,y,width,height", {file.string(), 1});
  RealBoxes boxes;
  for (int row = 2; std::getline(lines, line); ++row) {
    const Where where{file.string(), row};
    const std::vector<std::string> cells = cells_of(line);
    if (cells.size() != 5)
      throw Error(fmt::format("has {} cells; expected 5", cells.size()), where);
    const double frame = finite_number(cells[0], where);
    if (!(frame >= 0 && frame < 1e9) || frame != std::floor(frame))
      throw Error("'" + cells[0] + "' is no frame; expected a whole number from 0", where);
    const Box box{pixels(cells[1], where) - origin_px,
                  pixels(cells[2], where) - origin_px,
                  pixels(cells[3], where),
                  pixels(cells[4], where)};
    if (!(box.width > 0 && box.height > 0))
      throw Error("has a box without a size; expected width and height above 0", where);
    if (!boxes.emplace(static_cast<std::int64_t>(frame), box).second)
      throw Error("is the second box of frame " + cells[0], where);
  }
  if (!boxes.empty() && boxes.rbegin()->first - boxes.begin()->first >= kLongest)
    throw Error(fmt::format("spans the frames {} to {}; expected fewer than a million",
                            boxes.begin()->first,
                            boxes.rbegin()->first),
                {file.string()});
  if (boxes.size() < 2) throw Error("holds fewer than two boxes", {file.string()});
  return boxes;
}

RealBoxes without_jumps(const RealBoxes& boxes) {
  RealBoxes kept;
  for (const auto& [frame, box] : boxes) {
    std::vector<double> sizes;
    for (auto it = boxes.lower_bound(frame - kNeighbours);
         it != boxes.end() && it->first <= frame + kNeighbours;
         ++it)
      sizes.push_back(larger_side(it->second));
    const double middle = median(std::move(sizes));
    // One pixel is no jump, however small the aircraft.
    if (std::abs(larger_side(box) - middle) <= std::max(1.0, kMaxStray * middle))
      kept.emplace(frame, box);
  }
  return kept;
}

RealAircraft find_real(const fs::path& video,
                       const RealBoxes& loose,
                       std::int64_t most_frames,
                       const Warn& warn_to,
                       const std::stop_token& stop) {
  video::Reader reader(video, {.with_cuts = true}, warn_to);
  RealAircraft found;
  while (const auto frame = reader.next()) {
    if (stop.stop_requested()) throw Interrupted();
    if (frame->begins_shot) found.cuts.push_back(frame->index);
    const auto box = loose.find(frame->index);
    if (box == loose.end()) continue;
    if (const auto seen = appearance::seen_in(frame->picture, box->second)) {
      found.boxes.emplace(frame->index, seen->box);
      found.masks.emplace(frame->index, small_mask(seen->mask));
    }
  }
  keep_best_shot(video, warn_to, found);
  found.boxes = without_jumps(found.boxes);
  if (most_frames > 0 && !found.boxes.empty())
    found.boxes.erase(found.boxes.lower_bound(found.boxes.begin()->first + most_frames),
                      found.boxes.end());
  if (found.boxes.size() < kMinBoxes)
    throw Error(fmt::format("in {} of its boxes an aircraft stands out from its surroundings; "
                            "expected {} or more in one shot",
                            found.boxes.size(),
                            kMinBoxes),
                {video.string()});
  std::erase_if(found.masks, [&](const auto& one) { return !found.boxes.contains(one.first); });
  return found;
}

}  // namespace airtruth::match
