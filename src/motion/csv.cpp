// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <charconv>
#include <cmath>
#include <sstream>
#include <string>

#include <fmt/format.h>

#include "base/error.h"
#include "motion/motion.h"

namespace airtruth::motion {
namespace {

constexpr const char* kHeader =
    "frame,time_s,h11,h12,h13,h21,h22,h23,h31,h32,h33,inliers,rms_px,state";
constexpr std::size_t kCells = 14;

double number(const std::string& cell, const Where& where) {
  double value = 0;
  const char* end = cell.data() + cell.size();
  const auto [rest, failed] = std::from_chars(cell.data(), end, value);
  if (failed != std::errc() || rest != end || !std::isfinite(value))
    throw Error("'" + cell.substr(0, 40) + "' is not a finite number", where);
  return value;
}

State state_of(const std::string& word, const Where& where) {
  for (State state : {State::kReference, State::kMeasured, State::kBridged, State::kCut})
    if (word == name(state)) return state;
  throw Error("state is '" + word.substr(0, 40) + "'; expected reference, measured, bridged or cut",
              where);
}

}  // namespace

std::string csv_from_motion(const std::vector<FrameMotion>& motion) {
  std::string text = std::string(kHeader) + "\n";
  for (const FrameMotion& m : motion) {
    text += fmt::format("{},{}", m.frame, m.time_s);
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) text += fmt::format(",{}", m.frame_from_reference(r, c));
    text += fmt::format(",{},{},{}\n", m.inliers, m.rms_px, name(m.state));
  }
  return text;
}

std::vector<FrameMotion> motion_from_csv(std::string_view text, const std::filesystem::path& file) {
  std::istringstream lines{std::string(text)};
  std::string line;
  if (!std::getline(lines, line) || line != kHeader)
    throw Error(std::string("does not begin with ") + kHeader, {file.string(), 1});
  std::vector<FrameMotion> motion;
  for (int row = 2; std::getline(lines, line); ++row) {
    const Where where{file.string(), row};
    std::vector<std::string> cells;
    std::istringstream stream(line);
    for (std::string cell; std::getline(stream, cell, ',');) cells.push_back(cell);
    if (cells.size() != kCells)
      throw Error("has " + std::to_string(cells.size()) + " cells; expected 14", where);
    FrameMotion m;
    const double frame = number(cells[0], where);
    const double inliers = number(cells[11], where);
    if (std::abs(frame) > 1e15 || std::abs(inliers) > 1e9)
      throw Error("a count is too large", where);
    m.frame = static_cast<std::int64_t>(frame);
    m.time_s = number(cells[1], where);
    for (std::size_t i = 0; i < 9; ++i)
      m.frame_from_reference(static_cast<int>(i / 3), static_cast<int>(i % 3)) =
          number(cells[2 + i], where);
    m.inliers = static_cast<int>(inliers);
    m.rms_px = number(cells[12], where);
    m.state = state_of(cells[13], where);
    motion.push_back(m);
  }
  return motion;
}

}  // namespace airtruth::motion
