// SPDX-License-Identifier: Apache-2.0
#include "camera/motion/motion.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "foundation/base/error.h"
#include "foundation/base/text.h"

namespace airtruth::motion {

namespace {

constexpr const char* kHeader =
    "frame,time_s,h11,h12,h13,h21,h22,h23,h31,h32,h33,inliers,rms_px,state";
constexpr const char* kRotationHeader = "frame,time_s,qw,qx,qy,qz,inliers,rms_px,state";
constexpr std::size_t kCsvBlockBytes = std::size_t{1} << 16;  // chosen: few calls, little memory

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

void write_csv(const AddBytes& add, const std::vector<FrameMotion>& motion) {
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
    text += fmt::format(",{},{},{}\n", m.inliers, m.rms_px, enum_name(m.state));
    if (text.size() < kCsvBlockBytes) continue;
    add(text);
    text.clear();
  }
  add(text);
}

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

// What follows the packed frames of an entry.
constexpr std::string_view kToTheEnd = "to the end\n";  // of the video
constexpr std::string_view kUntilThere = "until there\n";

// The head of a packed frame; the numbers of its rotation or homography follow in Eigen's order.
struct PackedHead {
  double time_s;
  double rms_px;
  std::int32_t inliers;
  std::uint8_t state;
  bool is_rotation;
  bool begins_anew;
};
constexpr std::size_t kRotationNumbers = 4;
constexpr std::size_t kHomographyNumbers = 9;

std::size_t packed_size(bool is_rotation) {
  return sizeof(PackedHead) +
         sizeof(double) * (is_rotation ? kRotationNumbers : kHomographyNumbers);
}

FrameMotion unpacked(const char* bytes, std::int64_t frame) {
  PackedHead head;
  std::memcpy(&head, bytes, sizeof head);
  std::array<double, kHomographyNumbers> numbers{};
  std::memcpy(numbers.data(), bytes + sizeof head, packed_size(head.is_rotation) - sizeof head);
  FrameMotion motion{.frame = frame,
                     .time_s = head.time_s,
                     .rms_px = head.rms_px,
                     .inliers = head.inliers,
                     .state = static_cast<State>(head.state)};
  motion.begins_anew = head.begins_anew;
  if (head.is_rotation)
    motion.rotation = Quaternion(numbers.data());
  else
    motion.frame_from_reference = Eigen::Map<const Homography>(numbers.data());
  return motion;
}

// The packed frames of an entry's body, and whether they are all of the video.
struct Kept {
  std::string_view packed;
  bool to_the_end = false;

  std::size_t frame_size() const {
    if (packed.size() < sizeof(PackedHead)) return packed_size(true);
    PackedHead head;
    std::memcpy(&head, packed.data(), sizeof head);
    return packed_size(head.is_rotation);
  }
  std::size_t frames() const { return packed.size() / frame_size(); }
};

std::optional<Kept> kept_in(const std::optional<std::string>& body) {
  if (!body) return std::nullopt;
  const std::string_view text = *body;
  for (const std::string_view line : {kToTheEnd, kUntilThere}) {
    if (!text.ends_with(line)) continue;
    const Kept kept{text.substr(0, text.size() - line.size()), line == kToTheEnd};
    if (kept.packed.size() % kept.frame_size() == 0) return kept;
  }
  return std::nullopt;
}

}  // namespace

disk_cache::Key CacheKey::entry() const {
  // Smoothing is applied after the measurement, so the measured motion does not depend on it.
  disk_cache::Key key("motion");
  key.add(video_sha256).add(mask_sha256).add(first_frame).add(lens).add(options.seed);
  if (picture_rate_hz) key.add(*picture_rate_hz);
  return key;
}

void pack(const FrameMotion& motion, std::string& packed) {
  PackedHead head{};
  head.time_s = motion.time_s;
  head.rms_px = motion.rms_px;
  head.inliers = motion.inliers;
  head.state = static_cast<std::uint8_t>(motion.state);
  head.is_rotation = motion.rotation.has_value();
  head.begins_anew = motion.begins_anew;
  packed.append(reinterpret_cast<const char*>(&head), sizeof head);
  const double* numbers =
      motion.rotation ? motion.rotation->coeffs().data() : motion.frame_from_reference.data();
  packed.append(reinterpret_cast<const char*>(numbers),
                packed_size(head.is_rotation) - sizeof head);
}

std::optional<std::vector<FrameMotion>> cached(const disk_cache::Cache& cache,
                                               const CacheKey& key) {
  const auto body = cache.find(key.entry());
  const auto kept = kept_in(body);
  if (!kept) return std::nullopt;
  std::size_t count = kept->frames();
  if (key.frame_count < 0 && !kept->to_the_end) return std::nullopt;
  if (key.frame_count >= 0) {
    const auto wanted = static_cast<std::size_t>(key.frame_count);
    if (count < wanted && !kept->to_the_end) return std::nullopt;
    count = std::min(count, wanted);
  }
  std::vector<FrameMotion> motion;
  motion.reserve(count);
  for (std::size_t k = 0; k < count; ++k)
    motion.push_back(
        unpacked(kept->packed.data() + k * kept->frame_size(), static_cast<std::int64_t>(k)));
  return motion;
}

void store(const disk_cache::Cache& cache, const CacheKey& key, std::string packed) {
  Kept now{packed, true};
  now.to_the_end = key.frame_count < 0 || static_cast<std::int64_t>(now.frames()) < key.frame_count;
  const auto body = cache.find(key.entry());
  const auto before = kept_in(body);
  if (before && (before->to_the_end || (!now.to_the_end && before->frames() >= now.frames())))
    return;
  cache.keep(key.entry(), packed += now.to_the_end ? kToTheEnd : kUntilThere);
}

void store(const disk_cache::Cache& cache,
           const CacheKey& key,
           const std::vector<FrameMotion>& motion) {
  if (motion.empty()) return;
  std::string packed;
  // A string that grows holds its frames twice.
  packed.reserve(motion.size() * packed_size(motion.front().rotation.has_value()) +
                 kUntilThere.size());
  for (const FrameMotion& frame : motion) pack(frame, packed);
  store(cache, key, std::move(packed));
}

}  // namespace airtruth::motion
