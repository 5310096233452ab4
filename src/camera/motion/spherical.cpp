// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <vector>

#include <opencv2/core.hpp>

#include "camera/motion/corners.h"
#include "camera/motion/follower.h"
#include "camera/motion/patch.h"
#include "camera/motion/rotation_fit.h"

// The rotation of the camera from far points, whose directions in the reference camera are
// constant. The rotation of a frame is the one that maps these directions to the detected corners.
// Corners are tracked from the key frame that they were selected in, so that no drift accumulates
// while a key frame is in use. Corners of the previous frame (corners.h) tell where the landmarks
// are to be looked for, and couple neighbouring frames.
namespace airtruth::motion {
namespace {

// Both constants are chosen by judgement.
constexpr double kStepLimit = 3;         // the limit of an inlier of the first guess, in kInlierPx
constexpr double kUnknownTurnRad = 0.5;  // the error of the rotation after tracking was lost
// The share of few coarse corners that must move as one for the rest to be looked for where these
// lead. On 1,001 and 969 frames of two real flights 98 % of the frames have more; with a fifth of
// the picture on objects that wander by themselves 58 % have.
constexpr double kMinCommonShare = 0.75;

// The directions that the pixels of a camera show, and where in its pictures corners are allowed.
struct View {
  lens::Lens lens;
  cv::Mat allowed;  // 255 where corners are allowed (corners.h)

  bool is_allowed(const Pixel& p) const {
    const int x = static_cast<int>(std::floor(p.x()));
    const int y = static_cast<int>(std::floor(p.y()));
    return x >= 0 && y >= 0 && x < allowed.cols && y < allowed.rows &&
           allowed.at<unsigned char>(y, x) != 0;
  }
};

// A landmark of a key frame that was found in another frame.
struct Sighting {
  std::size_t key = 0;  // its place in the window
  std::size_t landmark = 0;
  Pixel now;
  Vector3 in_cam;
  // The landmark's direction in the reference camera.
  Vector3 in_reference;
  std::int64_t frames = 0;  // since the key frame
};

// How fits treat bearings.
struct FitLimits {
  double limit_rad = 0;  // the largest residual of an inlier
  std::uint64_t seed = 0;
  // The up direction in the reference camera, where a horizon is known (rotation_fit.h).
  std::optional<Vector3> up_in_reference;

  Bearings bearings(const Vector3& in_reference, const Vector3& in_cam, std::int64_t frames) const {
    if (!up_in_reference) return {in_reference, in_cam};
    return {in_reference, in_cam, nearness_of(in_reference, *up_in_reference, frames)};
  }
  std::optional<RotationFit> fit(const std::vector<Bearings>& bearings) const {
    return fit_rotation(bearings, limit_rad, kMinInliers, seed);
  }
};

// The constants of key frames are chosen by judgement; docs/accuracy.md has the drift that results.
// The first two are numbers of key frames and of landmarks.
constexpr std::size_t kMaxKeyFrames = 5;
constexpr std::size_t kFromOlderKey = 160;  // landmarks of a key frame that is not the newest
// A new key frame is made where a smaller share of the newest one's far points is found, or beyond
// kLargestTurnRad from it, where the patches around its corners look different.
constexpr double kMinProvenShare = 0.4;
constexpr double kLargestTurnRad = 0.2;
constexpr int kMaxMissesInRow = 3;  // a corner that is missed more often is dropped
constexpr int kSweeps = 4;          // passes over the sliding window

// A sliding window of key frames. Each holds patches around its corners, and the directions of the
// corners in its own camera. A new key frame is linked to all whose landmarks it shows; the
// rotations of the window are fitted to these links.
class KeyFrames {
 public:
  bool is_empty() const { return keys_.empty(); }

  // The landmarks that are found in a frame whose rotation (cam_from_reference) is about `guess`:
  // those of the newest key frame, and fewer of each older one.
  std::vector<Sighting> find(const Levels& now,
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
        const auto guess_px = view.lens.pixel_from_cam(now_from_key * landmark.in_key_cam);
        if (!guess_px) continue;
        const auto at = landmark.patch.find(now, *guess_px);
        if (!at || !view.is_allowed(*at)) continue;
        if (const auto ray = view.lens.ray_from_pixel(*at))
          sightings.push_back(
              {k, i, *at, *ray, reference_from_key * landmark.in_key_cam, frame - key.frame});
      }
    }
    return sightings;
  }

  // Notes which sightings are inliers of a frame's rotation. Landmarks that are missed repeatedly
  // are dropped by forget(). Returns whether the newest key frame is still good for the next frame.
  bool note(const std::vector<Sighting>& sightings, const RotationFit& fit) {
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
  void forget() {
    for (Key& key : keys_)
      std::erase_if(key.landmarks, [](const Landmark& l) { return l.misses >= kMaxMissesInRow; });
  }

  // Adds a frame as a key frame with landmarks at these corners, refines the rotations of the
  // window, and returns that of the new key frame. `sightings` links it to older key frames.
  Quaternion add(const Levels& now,
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
        if (const auto ray = view.lens.ray_from_pixel(patch->middle()))
          key.landmarks.push_back({*patch, *ray, 0});
    link(key.id, sightings, is_inlier);
    keys_.push_back(std::move(key));
    if (keys_.size() > kMaxKeyFrames) drop_oldest();
    refine(limits);
    return keys_.back().cam_from_reference;
  }

 private:
  struct Landmark {
    LevelPatch patch;
    Vector3 in_key_cam;
    int misses = 0;
  };
  struct Key {
    std::vector<Landmark> landmarks;
    std::size_t proven = 0;  // landmarks that were inliers in the first frame after it
    Quaternion cam_from_reference = Quaternion::Identity();
    int id = 0;
    std::int64_t frame = 0;
  };
  // The landmarks that two key frames share, in each one's own camera.
  struct Link {
    int from = 0;  // ids
    int to = 0;
    std::vector<Bearings> seen;
  };

  void link(int id, const std::vector<Sighting>& sightings, const std::vector<bool>& is_inlier) {
    for (std::size_t k = 0; k < keys_.size(); ++k) {
      Link link{keys_[k].id, id, {}};
      for (std::size_t i = 0; i < sightings.size(); ++i)
        if (sightings[i].key == k && is_inlier[i])
          link.seen.push_back(
              {keys_[k].landmarks[sightings[i].landmark].in_key_cam, sightings[i].in_cam});
      if (static_cast<int>(link.seen.size()) >= kMinInliers) links_.push_back(std::move(link));
    }
  }

  void drop_oldest() {
    const int gone = keys_.front().id;
    keys_.pop_front();
    std::erase_if(links_, [gone](const Link& l) { return l.from == gone || l.to == gone; });
  }

  // What a key frame shares with others, with the others' rotations as they are.
  std::vector<Bearings> bearings_of(const Key& key, const FitLimits& limits) const {
    std::vector<Bearings> all;
    for (const Link& link : links_) {
      if (link.from != key.id && link.to != key.id) continue;
      const bool is_later = link.to == key.id;
      const int other_id = is_later ? link.from : link.to;
      const Key& other = *std::ranges::find(keys_, other_id, &Key::id);
      const Quaternion reference_from_other = other.cam_from_reference.conjugate();
      const std::int64_t frames = std::abs(key.frame - other.frame);
      for (const Bearings& b : link.seen)
        all.push_back(
            is_later ? limits.bearings(reference_from_other * b.in_reference, b.in_cam, frames)
                     : limits.bearings(reference_from_other * b.in_cam, b.in_reference, frames));
    }
    return all;
  }

  // Fits the rotation of every key frame but the oldest to the landmarks that it shares with
  // others.
  void refine(const FitLimits& limits) {
    for (int sweep = 0; sweep < kSweeps; ++sweep)
      for (std::size_t k = 1; k < keys_.size(); ++k) {
        const std::vector<Bearings> all = bearings_of(keys_[k], limits);
        if (static_cast<int>(all.size()) < kMinInliers) continue;
        if (const auto fit = limits.fit(all)) keys_[k].cam_from_reference = fit->cam_from_reference;
      }
  }

  std::deque<Key> keys_;
  std::vector<Link> links_;
  int next_id_ = 0;
};

class Spherical : public Follower {
 public:
  Spherical(const lens::Lens& lens, const cv::Mat& allowed, std::uint64_t seed)
      : view_{lens, allowed} {
    limits_.limit_rad = kInlierPx / lens.focal_px();
    limits_.seed = seed;
  }

  FrameMotion next(const cv::Mat& grey, bool damaged, bool begins_shot) override {
    const Levels now = levels_of(grey);
    ++frame_;
    if (keys_.is_empty()) {
      make_key(now, {}, {});
      return unmeasured(State::kReference);
    }
    stray_rad_ = 0;
    if (damaged) return unmeasured(State::kBridged);
    const Guess found = guess(now);
    const std::size_t survivors = found.steps.size();
    if (found.cam_from_reference &&
        is_followed(begins_shot, static_cast<int>(survivors), previous_.size())) {
      const std::vector<Sighting> sightings =
          keys_.find(now, frame_, *found.cam_from_reference, view_);
      if (const auto rotation = fit(sightings, found.steps))
        return measured(now, sightings, *rotation);
    }
    return lost(now, survivors, begins_shot);
  }

  double stray_rad() const override { return stray_rad_; }
  void set_up(const std::optional<Vector3>& in_reference) override {
    limits_.up_in_reference = in_reference;
  }

 private:
  // Corners of the previous frame in this one, and the rotation that they show, where they do.
  struct Guess {
    std::vector<Step> steps;
    std::optional<Quaternion> cam_from_reference;
  };

  Guess guess(const Levels& now) const {
    Guess result;
    const std::vector<Step> few = previous_.coarse(now);
    auto fit = rough_fit(few);
    if (fit && fit->inliers >= kMinCommonShare * static_cast<double>(few.size())) {
      result.steps = steps_beside(now, fit->cam_from_reference);
    } else {
      result.steps = previous_.alone(now, view_.allowed);
      fit = limits_.fit(bearings_of(result.steps));
      if (!fit) fit = rough_fit(result.steps);
    }
    std::erase_if(result.steps, [this](const Step& s) { return !view_.is_allowed(s.to); });
    if (fit) result.cam_from_reference = fit->cam_from_reference;
    return result;
  }

  std::vector<Step> steps_beside(const Levels& now, const Quaternion& cam_from_reference) const {
    const Quaternion now_from_before = cam_from_reference * now_from_reference_.conjugate();
    return previous_.fine(now, [&](const Pixel& p) -> std::optional<Pixel> {
      const auto ray = view_.lens.ray_from_pixel(p);
      return ray ? view_.lens.pixel_from_cam(now_from_before * *ray) : std::nullopt;
    });
  }

  std::optional<RotationFit> rough_fit(const std::vector<Step>& steps) const {
    FitLimits wide = limits_;
    wide.limit_rad *= kStepLimit;
    return wide.fit(bearings_of(steps));
  }

  std::vector<Bearings> bearings_of(const std::vector<Step>& steps) const {
    const Quaternion reference_from_before = now_from_reference_.conjugate();
    std::vector<Bearings> pairs;
    for (const Step& s : steps) {
      const auto before = view_.lens.ray_from_pixel(s.from);
      const auto after = view_.lens.ray_from_pixel(s.to);
      if (before && after)
        pairs.push_back(limits_.bearings(reference_from_before * *before, *after, 1));
    }
    return pairs;
  }

  // The rotation by landmarks and steps together. Its inliers are those among the landmarks.
  std::optional<RotationFit> fit(const std::vector<Sighting>& sightings,
                                 const std::vector<Step>& steps) const {
    std::vector<Bearings> all;
    for (const Sighting& s : sightings)
      all.push_back(limits_.bearings(s.in_reference, s.in_cam, s.frames));
    const std::vector<Bearings> between = bearings_of(steps);
    all.insert(all.end(), between.begin(), between.end());
    auto fit = limits_.fit(all);
    if (!fit) return std::nullopt;
    fit->is_inlier.resize(sightings.size());
    fit->inliers = 0;
    double squares = 0;
    for (std::size_t i = 0; i < sightings.size(); ++i) {
      if (!fit->is_inlier[i]) continue;
      ++fit->inliers;
      squares += (all[i].in_cam - fit->cam_from_reference * all[i].in_reference).squaredNorm();
    }
    if (fit->inliers < kMinInliers) return std::nullopt;
    fit->rms_rad = std::sqrt(squares / fit->inliers);
    return fit;
  }

  // Whether a corner is far. The function is empty where no horizon is known.
  std::function<bool(const cv::Point2f&)> far_corners() const {
    if (!limits_.up_in_reference) return {};
    return [this, up = Vector3(now_from_reference_ * *limits_.up_in_reference)](
               const cv::Point2f& corner) {
      const auto ray = view_.lens.ray_from_pixel({corner.x + 0.5, corner.y + 0.5});
      return ray && nearness_of(*ray, up, 1).is_far;
    };
  }

  std::vector<Pixel> new_corners(const Levels& now) const {
    std::vector<Pixel> corners;
    for (const cv::Point2f& c : spread_corners(now.front(), view_.allowed, far_corners()))
      corners.emplace_back(c.x + 0.5, c.y + 0.5);
    return corners;
  }

  void make_key(const Levels& now,
                const std::vector<Sighting>& sightings,
                const std::vector<bool>& is_inlier) {
    const std::vector<Pixel> corners = new_corners(now);
    std::vector<Pixel> steps;
    for (std::size_t i = 0; i < sightings.size(); ++i)
      if (is_inlier[i]) steps.push_back(sightings[i].now);
    const std::size_t room =
        std::min(kMaxSteps - std::min(kMaxSteps, steps.size()), corners.size());
    for (std::size_t i = 0; i < room; ++i) steps.push_back(corners[i * corners.size() / room]);
    previous_.take(now, steps);
    now_from_reference_ =
        keys_.add(now, frame_, now_from_reference_, corners, sightings, is_inlier, view_, limits_);
  }

  FrameMotion measured(const Levels& now,
                       const std::vector<Sighting>& sightings,
                       const RotationFit& fit) {
    now_from_reference_ = fit.cam_from_reference;
    bridged_in_row_ = 0;
    if (keys_.note(sightings, fit)) {
      keys_.forget();
      std::vector<Pixel> corners;
      for (std::size_t i = 0; i < sightings.size(); ++i)
        if (fit.is_inlier[i]) corners.push_back(sightings[i].now);
      previous_.take(now, corners);
    } else {
      make_key(now, sightings, fit.is_inlier);
      stray_rad_ = fit.rms_rad / std::sqrt(double(fit.inliers));
    }
    FrameMotion motion;
    motion.rotation = now_from_reference_;
    motion.inliers = fit.inliers;
    motion.rms_px = fit.rms_rad * view_.lens.focal_px();
    motion.state = State::kMeasured;
    return motion;
  }

  FrameMotion unmeasured(State state) const {
    FrameMotion motion;
    motion.rotation = now_from_reference_;  // the last known rotation; the state says so
    motion.state = state;
    return motion;
  }

  FrameMotion lost(const Levels& now, std::size_t survivors, bool begins_shot) {
    ++bridged_in_row_;
    const std::size_t fresh = spread_corners(now.front(), view_.allowed).size();
    const CornerLoss loss =
        corner_loss(fresh, previous_.size(), survivors, bridged_in_row_, begins_shot);
    if (loss.starts_anew) {
      keys_ = KeyFrames();
      make_key(now, {}, {});
      stray_rad_ = kUnknownTurnRad;
      bridged_in_row_ = 0;
    }
    FrameMotion motion = unmeasured(loss.is_cut ? State::kCut : State::kBridged);
    motion.begins_anew = loss.starts_anew;
    return motion;
  }

  View view_;
  FitLimits limits_;
  KeyFrames keys_;
  Steps previous_;
  Quaternion now_from_reference_ = Quaternion::Identity();
  int bridged_in_row_ = 0;
  double stray_rad_ = 0;
  std::int64_t frame_ = 0;
};

}  // namespace

std::unique_ptr<Follower> spherical_follower(const lens::Lens& lens,
                                             const cv::Mat& allowed,
                                             std::uint64_t seed) {
  return std::make_unique<Spherical>(lens, allowed, seed);
}

}  // namespace airtruth::motion
