// SPDX-License-Identifier: Apache-2.0
#include "camera/motion/motion.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "foundation/base/error.h"
#include "foundation/base/text.h"

namespace airtruth::motion {

const char* name(State state) {
  switch (state) {
    case State::kReference:
      return "reference";
    case State::kMeasured:
      return "measured";
    case State::kBridged:
      return "bridged";
    case State::kTurnedAway:
      return "turned_away";
    case State::kCut:
      return "cut";
  }
  return "";
}

namespace {

constexpr const char* kHeader =
    "frame,time_s,h11,h12,h13,h21,h22,h23,h31,h32,h33,inliers,rms_px,state";
constexpr const char* kRotationHeader = "frame,time_s,qw,qx,qy,qz,inliers,rms_px,state";
// The number of columns of the two.
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

namespace {

// cos(85 degrees), chosen: there a pixel of the frame covers 1 / cos^2 = 130 times its length on
// the plane, so that the plane holds no detail.
constexpr double kMinDepthRatio = 0.0872;

bool is_within_reach(const Homography& frame_from_reference, int width, int height) {
  const double determinant = frame_from_reference.determinant();
  if (!frame_from_reference.allFinite() || determinant == 0) return false;
  // The cube root keeps the sign. H and -H are the same map, and the result has a positive
  // determinant.
  const Homography reference_from_frame = (frame_from_reference / std::cbrt(determinant)).inverse();
  if (!reference_from_frame.allFinite()) return false;
  // The denominator is linear in the pixel, so that its least value is at a corner.
  for (const Pixel& corner :
       {Pixel(0, 0), Pixel(width, 0), Pixel(0, height), Pixel(width, height)}) {
    const Vector3 in_reference = reference_from_frame * Vector3(corner.x(), corner.y(), 1);
    if (!(in_reference.z() > kMinDepthRatio)) return false;
  }
  return true;
}

}  // namespace

FrameMotion ReachGuard::next(FrameMotion motion) {
  if (motion.rotation) return motion;
  if (is_within_reach(motion.frame_from_reference, width_, height_)) {
    last_ = motion;
    return motion;
  }
  motion.frame_from_reference =
      last_ ? last_->frame_from_reference : Homography(Homography::Identity());
  motion.state = State::kTurnedAway;
  motion.inliers = 0;
  motion.rms_px = 0;
  return motion;
}

std::vector<FrameMotion> within_reach(std::vector<FrameMotion> against_first,
                                      int width,
                                      int height) {
  ReachGuard guard(width, height);
  for (FrameMotion& motion : against_first) motion = guard.next(std::move(motion));
  return against_first;
}

namespace {

// The first line of an entry, before the motion as CSV.
constexpr std::string_view kToTheEnd = "to the end\n";  // of the video
constexpr std::string_view kUntilThere = "until there\n";

struct Kept {
  std::vector<FrameMotion> motion;
  bool to_the_end = false;
};

Kept kept_from(const std::string& body) {
  const bool to_the_end = body.starts_with(kToTheEnd);
  if (!to_the_end && !body.starts_with(kUntilThere)) throw Error("is no motion");
  return {motion_from_csv(body.substr(body.find('\n') + 1), {}), to_the_end};
}

}  // namespace

disk_cache::Key CacheKey::entry() const {
  // Smoothing is applied after the measurement, so the measured motion does not depend on it.
  return disk_cache::Key("motion")
      .add(video_sha256)
      .add(mask_sha256)
      .add(first_frame)
      .add(lens)
      .add(options.max_corners)
      .add(options.min_corner_distance_px)
      .add(options.forward_backward_px)
      .add(options.ransac_px)
      .add(options.min_inliers)
      .add(options.seed);
}

std::optional<std::vector<FrameMotion>> cached(const disk_cache::Cache& cache,
                                               const CacheKey& key) {
  auto found = cache.find(key.entry(), kept_from);
  if (!found) return std::nullopt;
  const auto wanted = static_cast<std::size_t>(std::max<std::int64_t>(0, key.frame_count));
  if (key.frame_count < 0 ? !found->to_the_end
                          : found->motion.size() < wanted && !found->to_the_end)
    return std::nullopt;
  if (key.frame_count >= 0 && found->motion.size() > wanted) found->motion.resize(wanted);
  return std::move(found->motion);
}

void store(const disk_cache::Cache& cache,
           const CacheKey& key,
           const std::vector<FrameMotion>& motion) {
  const bool to_the_end =
      key.frame_count < 0 || static_cast<std::int64_t>(motion.size()) < key.frame_count;
  const auto before = cache.find(key.entry(), kept_from);
  if (before && (before->to_the_end || (!to_the_end && before->motion.size() >= motion.size())))
    return;
  cache.keep(key.entry(),
             std::string(to_the_end ? kToTheEnd : kUntilThere) + csv_from_motion(motion));
}

}  // namespace airtruth::motion
