// SPDX-License-Identifier: Apache-2.0
#include "foundation/base/csv.h"

#include <array>
#include <cmath>
#include <sstream>
#include <string>

#include <fmt/format.h>

#include "camera/motion/motion.h"
#include "foundation/base/error.h"

namespace airtruth::motion {
namespace {

constexpr const char* kHeader =
    "frame,time_s,h11,h12,h13,h21,h22,h23,h31,h32,h33,inliers,rms_px,state";
constexpr const char* kRotationHeader = "frame,time_s,qw,qx,qy,qz,inliers,rms_px,state";
constexpr std::size_t kCells = 14;
constexpr std::size_t kRotationCells = 9;

State state_of(const std::string& word, const Where& where) {
  for (State state :
       {State::kReference, State::kMeasured, State::kBridged, State::kCut, State::kTurnedAway})
    if (word == name(state)) return state;
  throw Error("state is '" + word.substr(0, 40) + "'; expected reference, measured, bridged or cut",
              where);
}

}  // namespace

std::string csv_from_motion(const std::vector<FrameMotion>& motion) {
  const bool rotations = !motion.empty() && motion.front().rotation;
  std::string text = std::string(rotations ? kRotationHeader : kHeader) + "\n";
  for (const FrameMotion& m : motion) {
    check(m.rotation.has_value() == rotations, "one model of motion");
    text += fmt::format("{},{}", m.frame, m.time_s);
    if (rotations)
      text += fmt::format(
          ",{},{},{},{}", m.rotation->w(), m.rotation->x(), m.rotation->y(), m.rotation->z());
    else
      for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) text += fmt::format(",{}", m.frame_from_reference(r, c));
    text += fmt::format(",{},{},{}\n", m.inliers, m.rms_px, name(m.state));
  }
  return text;
}

namespace {

FrameMotion motion_of(const std::vector<std::string>& cells, bool is_rotation, const Where& where) {
  const std::size_t expected = is_rotation ? kRotationCells : kCells;
  if (cells.size() != expected)
    throw Error(fmt::format("has {} cells; expected {}", cells.size(), expected), where);
  FrameMotion m;
  const double frame = finite_number(cells[0], where);
  const double inliers = finite_number(cells[expected - 3], where);
  if (std::abs(frame) > 1e15 || std::abs(inliers) > 1e9) throw Error("a count is too large", where);
  m.frame = static_cast<std::int64_t>(frame);
  m.time_s = finite_number(cells[1], where);
  if (is_rotation) {
    const auto q = [&](std::size_t i) { return finite_number(cells[2 + i], where); };
    m.rotation = Quaternion(q(0), q(1), q(2), q(3));
    if (std::abs(m.rotation->norm() - 1) > 1e-6)
      throw Error("qw,qx,qy,qz is no rotation; expected a unit quaternion", where);
  } else {
    for (std::size_t i = 0; i < 9; ++i)
      m.frame_from_reference(static_cast<int>(i / 3), static_cast<int>(i % 3)) =
          finite_number(cells[2 + i], where);
  }
  m.inliers = static_cast<int>(inliers);
  m.rms_px = finite_number(cells[expected - 2], where);
  m.state = state_of(cells[expected - 1], where);
  return m;
}

}  // namespace

std::vector<FrameMotion> motion_from_csv(std::string_view text, const std::filesystem::path& file) {
  std::istringstream lines{std::string(text)};
  std::string line;
  if (!std::getline(lines, line) || (line != kHeader && line != kRotationHeader))
    throw Error(std::string("does not begin with ") + kHeader + " or " + kRotationHeader,
                {file.string(), 1});
  const bool is_rotation = line == kRotationHeader;
  std::vector<FrameMotion> motion;
  for (int row = 2; std::getline(lines, line); ++row)
    motion.push_back(motion_of(cells_of(line), is_rotation, {file.string(), row}));
  return motion;
}

}  // namespace airtruth::motion
