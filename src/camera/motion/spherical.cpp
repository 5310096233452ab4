// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <deque>
#include <optional>

#include "camera/motion/corners.h"
#include "camera/motion/follower.h"
#include "camera/motion/rotation_fit.h"

// The rotation of the camera from far points, whose directions in the reference camera are
// constant. The rotation of a frame is the one that maps these directions to the detected corners.
// Corners are tracked from the key frame that they were selected in, not from the previous frame,
// so that no drift accumulates while a key frame is in use. Several key frames are in use at a
// time, and each new one is linked to all whose corners it shows (a sliding window).
namespace airtruth::motion {
namespace {

// All constants are chosen by judgement; decision 0016 has the drift that results.
constexpr std::size_t kMaxKeyFrames = 5;
constexpr std::size_t kFromOlderKey = 110;  // corners of a key frame that is not the newest
constexpr std::size_t kStepCorners = 150;   // corners of the previous frame, for the first guess
// A new key frame is made where a smaller share of the newest one's far points is found, or beyond
// kLargestTurnRad from it, where the patches around its corners look different.
constexpr double kMinProvenShare = 0.4;
constexpr double kLargestTurnRad = 0.2;
constexpr int kMaxMissesInRow = 3;       // a corner that is missed more often is dropped
constexpr int kSweeps = 4;               // passes over the sliding window
constexpr double kStepLimit = 3;         // the limit of an inlier of the first guess, in ransac_px
constexpr double kUnknownTurnRad = 0.5;  // the error of the rotation after tracking was lost

struct Landmark {
  cv::Point2f corner;  // the position in its key frame
  Vector3 in_key_cam;
  int misses = 0;
};

struct Key {
  Pyramid pyramid;
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

struct Sighting {
  std::size_t key = 0;
  std::size_t landmark = 0;
  cv::Point2f now;
  Vector3 in_cam;
};

class Spherical : public Follower {
 public:
  Spherical(const lens::Lens& lens, const cv::Mat& allowed, const Options& options)
      : lens_(lens),
        allowed_(allowed),
        options_(options),
        limit_rad_(options.ransac_px / lens.focal_px()) {}

  FrameMotion next(const cv::Mat& grey, bool damaged, bool begins_shot) override {
    Pyramid now = pyramid_of(grey);
    ++frame_;
    if (keys_.empty()) {
      make_key(grey, now, {});
      previous_ = std::move(now);
      FrameMotion first;
      first.rotation = now_from_reference_;
      return first;
    }
    stray_rad_ = 0;
    if (damaged) return unmeasured(State::kBridged);
    std::size_t survivors = 0;
    const std::size_t before = previous_corners_.size();
    std::vector<Bearings> steps;
    const auto guess = step(now, survivors, steps);
    if (guess && is_followed(begins_shot, static_cast<int>(survivors), before)) {
      const std::vector<Sighting> sightings = find_landmarks(now, *guess);
      std::vector<Bearings> all = bearings_of(sightings);
      all.insert(all.end(), steps.begin(), steps.end());
      auto fit = fit_rotation(all, limit_rad_, options_.min_inliers, options_.seed);
      if (fit) fit = of_first(*fit, all, sightings.size());
      if (fit) return measured(grey, std::move(now), sightings, *fit);
    }
    return lost(grey, std::move(now), before, survivors, begins_shot);
  }

  double stray_rad() const override { return stray_rad_; }
  void set_up(const std::optional<Vector3>& in_reference) override {
    up_in_reference_ = in_reference;
  }

 private:
  std::optional<Vector3> bearing(const cv::Point2f& p) const {
    return lens_.ray_from_pixel({p.x + 0.5, p.y + 0.5});
  }

  // Whether a corner is far. The function is empty where no horizon is known.
  std::function<bool(const cv::Point2f&)> far_corners() const {
    if (!up_in_reference_) return {};
    return
        [this, up = Vector3(now_from_reference_ * *up_in_reference_)](const cv::Point2f& corner) {
          const auto ray = bearing(corner);
          return ray && nearness_of(*ray, up, 1).is_far;
        };
  }

  Bearings bearings(const Vector3& in_reference, const Vector3& in_cam, std::int64_t frames) const {
    if (!up_in_reference_) return {in_reference, in_cam};
    return {in_reference, in_cam, nearness_of(in_reference, *up_in_reference_, frames)};
  }

  // A rough rotation of the camera, from the corners of the previous frame.
  std::optional<Quaternion> step(const Pyramid& now,
                                 std::size_t& survivors,
                                 std::vector<Bearings>& pairs) const {
    std::vector<cv::Point2f> moved;
    const auto good = follow(previous_, now, allowed_, previous_corners_, moved, false, options_);
    for (std::size_t i = 0; i < good.size(); ++i) {
      if (!good[i]) continue;
      ++survivors;
      const auto before = bearing(previous_corners_[i]);
      const auto after = bearing(moved[i]);
      if (before && after)
        pairs.push_back(bearings(now_from_reference_.conjugate() * *before, *after, 1));
    }
    const auto fit =
        fit_rotation(pairs, kStepLimit * limit_rad_, options_.min_inliers, options_.seed);
    if (!fit) return std::nullopt;
    return fit->cam_from_reference;
  }

  std::vector<Sighting> find_landmarks(const Pyramid& now, const Quaternion& guess) const {
    std::vector<Sighting> sightings;
    for (std::size_t k = 0; k < keys_.size(); ++k) {
      const Key& key = keys_[k];
      if (guess.angularDistance(key.cam_from_reference) > kLargestTurnRad && k + 1 < keys_.size())
        continue;
      const Quaternion now_from_key = guess * key.cam_from_reference.conjugate();
      const std::size_t most = k + 1 == keys_.size() ? key.landmarks.size() : kFromOlderKey;
      const std::size_t stride =
          std::max<std::size_t>(1, key.landmarks.size() / std::max<std::size_t>(1, most));
      std::vector<std::size_t> which;
      std::vector<cv::Point2f> corners;
      std::vector<cv::Point2f> moved;
      for (std::size_t i = 0; i < key.landmarks.size(); i += stride) {
        const auto pixel = lens_.pixel_from_cam(now_from_key * key.landmarks[i].in_key_cam);
        if (!pixel || pixel->x() < 1 || pixel->y() < 1 || pixel->x() > allowed_.cols - 1 ||
            pixel->y() > allowed_.rows - 1)
          continue;
        which.push_back(i);
        corners.push_back(key.landmarks[i].corner);
        moved.emplace_back(static_cast<float>(pixel->x() - 0.5),
                           static_cast<float>(pixel->y() - 0.5));
      }
      const auto good = follow(key.pyramid, now, allowed_, corners, moved, true, options_);
      for (std::size_t i = 0; i < good.size(); ++i) {
        if (!good[i]) continue;
        if (const auto ray = bearing(moved[i])) sightings.push_back({k, which[i], moved[i], *ray});
      }
    }
    return sightings;
  }

  // The fit restricted to the first `count` bearings.
  std::optional<RotationFit> of_first(RotationFit fit,
                                      const std::vector<Bearings>& all,
                                      std::size_t count) const {
    fit.is_inlier.resize(count);
    fit.inliers = 0;
    double squares = 0;
    for (std::size_t i = 0; i < count; ++i) {
      if (!fit.is_inlier[i]) continue;
      ++fit.inliers;
      squares += (all[i].in_cam - fit.cam_from_reference * all[i].in_reference).squaredNorm();
    }
    if (fit.inliers < options_.min_inliers) return std::nullopt;
    fit.rms_rad = std::sqrt(squares / fit.inliers);
    return fit;
  }

  std::vector<Bearings> bearings_of(const std::vector<Sighting>& sightings) const {
    std::vector<Bearings> result;
    for (const Sighting& s : sightings) {
      const Key& key = keys_[s.key];
      result.push_back(
          bearings(key.cam_from_reference.conjugate() * key.landmarks[s.landmark].in_key_cam,
                   s.in_cam,
                   frame_ - key.frame));
    }
    return result;
  }

  FrameMotion measured(const cv::Mat& grey,
                       Pyramid now,
                       const std::vector<Sighting>& sightings,
                       const RotationFit& fit) {
    now_from_reference_ = fit.cam_from_reference;
    bridged_in_row_ = 0;
    FrameMotion motion;
    motion.rotation = now_from_reference_;
    motion.inliers = fit.inliers;
    motion.rms_px = fit.rms_rad * lens_.focal_px();
    motion.state = State::kMeasured;
    remember_corners(sightings, fit);
    std::size_t newest = 0;
    for (std::size_t i = 0; i < sightings.size(); ++i) {
      Landmark& landmark = keys_[sightings[i].key].landmarks[sightings[i].landmark];
      landmark.misses = fit.is_inlier[i] ? 0 : landmark.misses + 1;
      newest += fit.is_inlier[i] && sightings[i].key + 1 == keys_.size() ? 1 : 0;
    }
    Key& last = keys_.back();
    if (last.proven == 0) last.proven = newest;
    const bool far = now_from_reference_.angularDistance(last.cam_from_reference) > kLargestTurnRad;
    if (far || static_cast<double>(newest) < kMinProvenShare * static_cast<double>(last.proven)) {
      make_key(grey, now, links_of(sightings, fit));
      stray_rad_ = fit.rms_rad / std::sqrt(double(fit.inliers));
      motion.rotation = now_from_reference_ = keys_.back().cam_from_reference;
    } else {
      for (Key& key : keys_)
        std::erase_if(key.landmarks, [](const Landmark& l) { return l.misses >= kMaxMissesInRow; });
    }
    previous_ = std::move(now);
    return motion;
  }

  void remember_corners(const std::vector<Sighting>& sightings, const RotationFit& fit) {
    previous_corners_.clear();
    const std::size_t stride =
        std::max<std::size_t>(1, static_cast<std::size_t>(fit.inliers) / kStepCorners);
    std::size_t count = 0;
    for (std::size_t i = 0; i < sightings.size(); ++i)
      if (fit.is_inlier[i] && count++ % stride == 0) previous_corners_.push_back(sightings[i].now);
  }

  std::vector<Link> links_of(const std::vector<Sighting>& sightings, const RotationFit& fit) const {
    std::vector<Link> links;
    for (std::size_t k = 0; k < keys_.size(); ++k) {
      Link link{keys_[k].id, next_id_, {}};
      for (std::size_t i = 0; i < sightings.size(); ++i)
        if (sightings[i].key == k && fit.is_inlier[i])
          link.seen.push_back(
              {keys_[k].landmarks[sightings[i].landmark].in_key_cam, sightings[i].in_cam});
      if (static_cast<int>(link.seen.size()) >= options_.min_inliers)
        links.push_back(std::move(link));
    }
    return links;
  }

  void make_key(const cv::Mat& grey, const Pyramid& now, std::vector<Link> links) {
    Key key;
    key.pyramid = now;
    key.cam_from_reference = now_from_reference_;
    key.id = next_id_++;
    key.frame = frame_;
    for (const cv::Point2f& corner : spread_corners(grey, allowed_, options_, far_corners()))
      if (const auto ray = bearing(corner)) key.landmarks.push_back({corner, *ray, 0});
    previous_corners_.clear();
    const std::size_t stride = std::max<std::size_t>(1, key.landmarks.size() / kStepCorners);
    for (std::size_t i = 0; i < key.landmarks.size(); i += stride)
      previous_corners_.push_back(key.landmarks[i].corner);
    keys_.push_back(std::move(key));
    for (Link& link : links) links_.push_back(std::move(link));
    if (keys_.size() > kMaxKeyFrames) {
      const int gone = keys_.front().id;
      keys_.pop_front();
      std::erase_if(links_, [gone](const Link& l) { return l.from == gone || l.to == gone; });
    }
    refine_keys();
  }

  // Fits the rotation of every key frame but the oldest to the landmarks that it shares with
  // others.
  void refine_keys() {
    const auto find = [&](int id) {
      return std::find_if(keys_.begin(), keys_.end(), [id](const Key& k) { return k.id == id; });
    };
    for (int sweep = 0; sweep < kSweeps; ++sweep)
      for (std::size_t k = 1; k < keys_.size(); ++k) {
        std::vector<Bearings> all;
        for (const Link& link : links_) {
          if (link.from != keys_[k].id && link.to != keys_[k].id) continue;
          const bool is_later = link.to == keys_[k].id;
          const Key& other = *find(is_later ? link.from : link.to);
          const Quaternion reference_from_other = other.cam_from_reference.conjugate();
          const std::int64_t frames = std::abs(keys_[k].frame - other.frame);
          for (const Bearings& b : link.seen)
            all.push_back(is_later
                              ? bearings(reference_from_other * b.in_reference, b.in_cam, frames)
                              : bearings(reference_from_other * b.in_cam, b.in_reference, frames));
        }
        if (static_cast<int>(all.size()) < options_.min_inliers) continue;
        const auto fit = fit_rotation(all, limit_rad_, options_.min_inliers, options_.seed);
        if (fit) keys_[k].cam_from_reference = fit->cam_from_reference;
      }
  }

  FrameMotion unmeasured(State state) const {
    FrameMotion motion;
    motion.rotation = now_from_reference_;  // the last known rotation; the state says so
    motion.state = state;
    return motion;
  }

  FrameMotion lost(const cv::Mat& grey,
                   Pyramid now,
                   std::size_t before,
                   std::size_t survivors,
                   bool begins_shot) {
    ++bridged_in_row_;
    const auto fresh = spread_corners(grey, allowed_, options_);
    const CornerLoss loss = corner_loss(
        fresh.size(), before, survivors, bridged_in_row_, options_.min_inliers, begins_shot);
    if (loss.starts_anew) {
      keys_.clear();
      links_.clear();
      make_key(grey, now, {});
      stray_rad_ = kUnknownTurnRad;
      previous_ = std::move(now);
      bridged_in_row_ = 0;
    }
    return unmeasured(loss.is_cut ? State::kCut : State::kBridged);
  }

  lens::Lens lens_;
  cv::Mat allowed_;
  Options options_;
  double limit_rad_;
  std::deque<Key> keys_;
  std::vector<Link> links_;
  int next_id_ = 0;
  Pyramid previous_;
  std::vector<cv::Point2f> previous_corners_;
  Quaternion now_from_reference_ = Quaternion::Identity();
  int bridged_in_row_ = 0;
  double stray_rad_ = 0;
  std::int64_t frame_ = 0;
  std::optional<Vector3> up_in_reference_;
};

}  // namespace

std::unique_ptr<Follower> spherical_follower(const lens::Lens& lens,
                                             const cv::Mat& allowed,
                                             const Options& options) {
  return std::make_unique<Spherical>(lens, allowed, options);
}

}  // namespace airtruth::motion
