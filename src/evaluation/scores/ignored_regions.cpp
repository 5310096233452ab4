// SPDX-License-Identifier: Apache-2.0
#include "evaluation/scores/ignored_regions.h"

#include <array>
#include <cmath>
#include <string_view>

#include "foundation/base/error.h"
#include "foundation/base/text.h"
#include "labels/exchange/text.h"

namespace airtruth::scores {
namespace {

constexpr std::string_view kHead = "sequence,first_frame,last_frame,x,y,width,height";
constexpr std::size_t kCells = 7;    // of kHead
constexpr double kMostFrames = 1e9;  // a year at 30 frames/s
// Far outside any picture.
constexpr double kMostPixels = 1e6;

std::optional<std::int64_t> frame_of(const std::string& cell, const Where& where) {
  if (cell.empty()) return std::nullopt;
  const double value = finite_number(cell, where);
  if (value < 0 || value > kMostFrames || value != std::floor(value))
    throw Error("frame is '" + cell + "'; expected a whole number from 0 on", where);
  return static_cast<std::int64_t>(value);
}

IgnoredRegion region_of(const std::vector<std::string>& cells, const Where& where) {
  IgnoredRegion region;
  region.line = where.line;
  region.sequence = cells[0];
  if (region.sequence.empty()) throw Error("names no sequence", where);
  region.first_frame = frame_of(cells[1], where).value_or(0);
  region.last_frame = frame_of(cells[2], where);
  if (region.last_frame && *region.last_frame < region.first_frame)
    throw Error("ends with frame " + cells[2] + ", before it begins", where);
  std::array<double, 4> box{};
  for (std::size_t i = 0; i < 4; ++i) {
    box[i] = finite_number(cells[3 + i], where);
    if (std::abs(box[i]) > kMostPixels)
      throw Error("is at " + cells[3 + i] + "; expected pixels up to 1000000", where);
  }
  region.box_px = {box[0], box[1], box[2], box[3]};
  if (!(region.box_px.width > 0) || !(region.box_px.height > 0))
    throw Error("has no area; expected a width and a height above 0", where);
  return region;
}

}  // namespace

std::vector<IgnoredRegion> read_ignored_regions(const fs::path& file) {
  std::vector<IgnoredRegion> regions;
  bool has_head = false;
  for (const exchange::Line& line : exchange::lines_of(file)) {
    const Where where{file.string(), line.number};
    const std::vector<std::string> cells = cells_of(line.text);
    if (!has_head) {
      if (cells != cells_of(kHead))
        throw Error("is no heading of ignored regions; expected " + std::string(kHead), where);
      has_head = true;
      continue;
    }
    if (cells.size() != kCells)
      throw Error("has " + std::to_string(cells.size()) + " cells; expected " + std::string(kHead),
                  where);
    regions.push_back(region_of(cells, where));
  }
  if (!has_head) throw Error("is empty; expected " + std::string(kHead), {file.string()});
  return regions;
}

}  // namespace airtruth::scores
