// SPDX-License-Identifier: Apache-2.0
#include "benchmark/match/boxes.h"

#include <cmath>
#include <cstdint>
#include <sstream>

#include <fmt/format.h>

#include "foundation/base/csv.h"
#include "foundation/base/error.h"
#include "foundation/base/files.h"

namespace airtruth::match {
namespace {

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
  std::istringstream lines(read_file(file));
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

}  // namespace airtruth::match
