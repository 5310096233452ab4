// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <deque>
#include <optional>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>

#include "camera/lens/lens.h"
#include "camera/motion/follower.h"
#include "camera/motion/patch.h"
#include "camera/motion/rotation_fit.h"
#include "foundation/geometry/transform.h"

namespace airtruth::motion {

// The directions that the pixels of a camera show, and where in its pictures corners are allowed.
class View {
 public:
  // `allowed` is 255 where corners are allowed (corners.h).
  View(lens::Lens lens, cv::Mat allowed) : lens_(std::move(lens)), allowed_(std::move(allowed)) {}

  std::optional<Vector3> bearing(const Pixel& p) const { return lens_.ray_from_pixel(p); }
  std::optional<Pixel> pixel(const Vector3& in_cam) const { return lens_.pixel_from_cam(in_cam); }
  bool is_allowed(const Pixel& p) const {
    const int x = static_cast<int>(std::floor(p.x()));
    const int y = static_cast<int>(std::floor(p.y()));
    return x >= 0 && y >= 0 && x < allowed_.cols && y < allowed_.rows &&
           allowed_.at<unsigned char>(y, x) != 0;
  }
  const cv::Mat& allowed() const { return allowed_; }
  double focal_px() const { return lens_.focal_px(); }

 private:
  lens::Lens lens_;
  cv::Mat allowed_;
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

  Bearings bearings(const Vector3& in_reference, const Vector3& in_cam, std::int64_t frames) const;
  std::optional<RotationFit> fit(const std::vector<Bearings>& bearings) const {
    return fit_rotation(bearings, limit_rad, kMinInliers, seed);
  }
};

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
                             const View& view) const;
  // Notes which sightings are inliers of a frame's rotation. Landmarks that are missed repeatedly
  // are dropped by forget(). Returns whether the newest key frame is still good for the next frame.
  bool note(const std::vector<Sighting>& sightings, const RotationFit& fit);
  void forget();

  // Adds a frame as a key frame with landmarks at these corners, refines the rotations of the
  // window, and returns that of the new key frame. `sightings` links it to older key frames.
  Quaternion add(const Levels& now,
                 std::int64_t frame,
                 const Quaternion& cam_from_reference,
                 const std::vector<Pixel>& corners,
                 const std::vector<Sighting>& sightings,
                 const std::vector<bool>& is_inlier,
                 const View& view,
                 const FitLimits& limits);

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

  void link(int id, const std::vector<Sighting>& sightings, const std::vector<bool>& is_inlier);
  void drop_oldest();
  std::vector<Bearings> bearings_of(const Key& key, const FitLimits& limits) const;
  void refine(const FitLimits& limits);

  std::deque<Key> keys_;
  std::vector<Link> links_;
  int next_id_ = 0;
};

}  // namespace airtruth::motion
