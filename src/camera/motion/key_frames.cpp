// SPDX-License-Identifier: Apache-2.0
#include "camera/motion/key_frames.h"

#include <algorithm>
#include <cmath>

namespace airtruth::motion {
namespace {

// All constants are chosen by judgement; docs/accuracy.md has the drift that results. The first two
// are numbers of key frames and of landmarks.
constexpr std::size_t kMaxKeyFrames = 5;
constexpr std::size_t kFromOlderKey = 160;  // landmarks of a key frame that is not the newest
// A new key frame is made where a smaller share of the newest one's far points is found, or beyond
// kLargestTurnRad from it, where the patches around its corners look different.
constexpr double kMinProvenShare = 0.4;
constexpr double kLargestTurnRad = 0.2;
constexpr int kMaxMissesInRow = 3;  // a corner that is missed more often is dropped
constexpr int kSweeps = 4;          // passes over the sliding window

}  // namespace

Bearings FitLimits::bearings(const Vector3& in_reference,
                             const Vector3& in_cam,
                             std::int64_t frames) const {
  if (!up_in_reference) return {in_reference, in_cam};
  return {in_reference, in_cam, nearness_of(in_reference, *up_in_reference, frames)};
}

std::vector<Sighting> KeyFrames::find(const Levels& now,
                                      std::int64_t frame,
                                      const Quaternion& guess,
                                      const View& view) const {
  std::vector<Sighting> sightings;
  for (std::size_t k = 0; k < keys_.size(); ++k) {
    const Key& key = keys_[k];
    const bool is_newest = k + 1 == keys_.size();
    if (guess.angularDistance(key.cam_from_reference) > kLargestTurnRad && !is_newest) continue;
    const Matrix3 reference_from_key = key.cam_from_reference.conjugate().toRotationMatrix();
    const Matrix3 now_from_key = guess.toRotationMatrix() * reference_from_key;
    const std::size_t size = key.landmarks.size();
    const std::size_t count = is_newest ? size : std::min(size, kFromOlderKey);
    for (std::size_t j = 0; j < count; ++j) {
      const std::size_t i = j * size / count;
      const Landmark& landmark = key.landmarks[i];
      const auto guess_px = view.pixel(now_from_key * landmark.in_key_cam);
      if (!guess_px) continue;
      const auto at = landmark.patch.find(now, *guess_px);
      if (!at || !view.is_allowed(*at)) continue;
      if (const auto ray = view.bearing(*at))
        sightings.push_back(
            {k, i, *at, *ray, reference_from_key * landmark.in_key_cam, frame - key.frame});
    }
  }
  return sightings;
}

bool KeyFrames::note(const std::vector<Sighting>& sightings, const RotationFit& fit) {
  std::size_t of_newest = 0;
  for (std::size_t i = 0; i < sightings.size(); ++i) {
    Landmark& landmark = keys_[sightings[i].key].landmarks[sightings[i].landmark];
    landmark.misses = fit.is_inlier[i] ? 0 : landmark.misses + 1;
    of_newest += fit.is_inlier[i] && sightings[i].key + 1 == keys_.size() ? 1 : 0;
  }
  Key& newest = keys_.back();
  if (newest.proven == 0) newest.proven = of_newest;
  const double turn_rad = fit.cam_from_reference.angularDistance(newest.cam_from_reference);
  return turn_rad <= kLargestTurnRad &&
         static_cast<double>(of_newest) >= kMinProvenShare * static_cast<double>(newest.proven);
}

void KeyFrames::forget() {
  for (Key& key : keys_)
    std::erase_if(key.landmarks, [](const Landmark& l) { return l.misses >= kMaxMissesInRow; });
}

Quaternion KeyFrames::add(const Levels& now,
                          std::int64_t frame,
                          const Quaternion& cam_from_reference,
                          const std::vector<Pixel>& corners,
                          const std::vector<Sighting>& sightings,
                          const std::vector<bool>& is_inlier,
                          const View& view,
                          const FitLimits& limits) {
  Key key;
  key.cam_from_reference = cam_from_reference;
  key.id = next_id_++;
  key.frame = frame;
  for (const Pixel& corner : corners)
    if (const auto patch = LevelPatch::around(now, 0, corner))
      if (const auto ray = view.bearing(patch->middle()))
        key.landmarks.push_back({*patch, *ray, 0});
  link(key.id, sightings, is_inlier);
  keys_.push_back(std::move(key));
  if (keys_.size() > kMaxKeyFrames) drop_oldest();
  refine(limits);
  return keys_.back().cam_from_reference;
}

void KeyFrames::link(int id,
                     const std::vector<Sighting>& sightings,
                     const std::vector<bool>& is_inlier) {
  for (std::size_t k = 0; k < keys_.size(); ++k) {
    Link link{keys_[k].id, id, {}};
    for (std::size_t i = 0; i < sightings.size(); ++i)
      if (sightings[i].key == k && is_inlier[i])
        link.seen.push_back(
            {keys_[k].landmarks[sightings[i].landmark].in_key_cam, sightings[i].in_cam});
    if (static_cast<int>(link.seen.size()) >= kMinInliers) links_.push_back(std::move(link));
  }
}

void KeyFrames::drop_oldest() {
  const int gone = keys_.front().id;
  keys_.pop_front();
  std::erase_if(links_, [gone](const Link& l) { return l.from == gone || l.to == gone; });
}

// What a key frame shares with others, with the others' rotations as they are.
std::vector<Bearings> KeyFrames::bearings_of(const Key& key, const FitLimits& limits) const {
  std::vector<Bearings> all;
  for (const Link& link : links_) {
    if (link.from != key.id && link.to != key.id) continue;
    const bool is_later = link.to == key.id;
    const int other_id = is_later ? link.from : link.to;
    const Key& other = *std::find_if(
        keys_.begin(), keys_.end(), [other_id](const Key& k) { return k.id == other_id; });
    const Quaternion reference_from_other = other.cam_from_reference.conjugate();
    const std::int64_t frames = std::abs(key.frame - other.frame);
    for (const Bearings& b : link.seen)
      all.push_back(is_later
                        ? limits.bearings(reference_from_other * b.in_reference, b.in_cam, frames)
                        : limits.bearings(reference_from_other * b.in_cam, b.in_reference, frames));
  }
  return all;
}

// Fits the rotation of every key frame but the oldest to the landmarks that it shares with others.
void KeyFrames::refine(const FitLimits& limits) {
  for (int sweep = 0; sweep < kSweeps; ++sweep)
    for (std::size_t k = 1; k < keys_.size(); ++k) {
      const std::vector<Bearings> all = bearings_of(keys_[k], limits);
      if (static_cast<int>(all.size()) < kMinInliers) continue;
      if (const auto fit = limits.fit(all)) keys_[k].cam_from_reference = fit->cam_from_reference;
    }
}

}  // namespace airtruth::motion
