// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "foundation/base/files.h"
#include "foundation/base/names.h"
#include "foundation/disk_cache/disk_cache.h"
#include "foundation/geometry/transform.h"

// The motion of the camera, measured from the video. The estimator selects strong corners (Shi and
// Tomasi 1994) that are spread over the image outside the own aircraft. It tracks them by pyramidal
// Lucas-Kanade (Bouguet 2001) with a forward-backward check (Kalal 2010). It then fits one of two
// models to the tracks:
//
// homography (the paper, section II.C): one plane map per frame. RANSAC (Fischler and Bolles 1981)
// fits the map to the key frame, and least squares refines it on the inliers. A new key frame
// begins before few tracks are left; the maps between key frames are composed.
//
// rotation: a known lens turns corners into bearings, and the bearings of far points change by the
// rotation of the camera alone. RANSAC and robust least squares fit one rotation per frame; near
// ground and the own aircraft become outliers (rotation_fit.h). The model is exact for any lens,
// whereas a homography is exact for a pinhole alone. Detected horizons correct the drift of pitch
// and roll (horizon.h).
//
// Example: a pinhole of 1920 x 1080 pixels and a focal length of 1662.8 px turns right by 1 degree.
// The far point at the image's centre (960, 540) moves by 1662.8 tan(1 deg) = 29.0 px to the left,
// to (931.0, 540). The model rotation gives a rotation vector of (0, -1 deg, 0) as
// cam_from_reference_cam; the model homography gives a map that takes (960, 540) to (931.0, 540).
namespace airtruth::motion {

enum class State {
  kReference,  // the first frame: identity by definition
  kMeasured,
  // The frame could not be measured (blank sky, blur, damage). Its motion is extrapolated from its
  // neighbours.
  kBridged,
  // The scene changed: nothing links the frame to the frames before it. Its motion is extrapolated.
  kCut,
  // Homographies only: the camera has turned or flown so far from the first frame that no plane map
  // holds both pictures (ReachGuard). The motion is that of the last frame within reach.
  kTurnedAway,
};
// The names of the states in motion.csv.
constexpr auto enum_names(State) {
  return std::to_array<EnumName<State>>({{State::kReference, "reference"},
                                         {State::kMeasured, "measured"},
                                         {State::kBridged, "bridged"},
                                         {State::kCut, "cut"},
                                         {State::kTurnedAway, "turned_away"}});
}

// Whether the motion of a frame in this state is known. Otherwise it is taken from other frames.
inline bool is_known(State state) {
  return state == State::kReference || state == State::kMeasured;
}

struct FrameMotion {
  std::int64_t frame = 0;
  double time_s = 0;
  // The root mean square reprojection error of the inliers, in pixels of the frame.
  double rms_px = 0;
  int inliers = 0;
  State state = State::kReference;
  // p_in_frame ~ H p_in_reference, in airtruth's pixels (corner origin), h33 = 1. The reference is
  // the first frame, or the smoothed camera path. The map is the identity for the model rotation.
  Homography frame_from_reference = Homography::Identity();
  // cam_from_reference_cam of the model rotation; empty for the model homography.
  std::optional<Quaternion> rotation;
  // Whether the rotation does not continue that of the frame before it: a cut, tracking that starts
  // anew, and the horizon's first correction after either.
  bool begins_anew = false;
};

struct Options {
  // For a smoothed camera path: the standard deviation of the Gaussian window over time.
  double smoothing_s = 1.0;
  // The seed of the random samples of RANSAC, for the model rotation.
  std::uint64_t seed = 1;
};

// Writes motion.csv line by line. The columns are frame,time_s,h11,...,h33,inliers,rms_px,state
// for homographies and frame,time_s,qw,qx,qy,qz,inliers,rms_px,state for rotations. Numbers
// round-trip exactly.
void write_csv(const AddBytes& add, const std::vector<FrameMotion>& motion);

// The limit of a homography. One plane shows only what lies ahead of the reference camera: for
// a turn, the map of unit determinant from the frame to the reference has at a pixel the
// denominator cos(a) / cos(b), where a and b are the angles of the pixel's ray from the axes of
// reference and frame (Hartley and Zisserman, Multiple View Geometry, 13.2: H = K R K^-1). It is
// independent of the focal length. Where it is not above 0 the pixel's ray leaves the reference
// camera backward, and the plane shows it somewhere else; shortly before that a pixel of the frame
// is stretched over hundreds on the plane.
//
// A frame with such a pixel is not measured against the reference, even where its motion against
// its neighbours is known. It gets the state kTurnedAway and the motion of the last frame within
// reach.
class ReachGuard {
 public:
  ReachGuard(int width, int height) : width_(width), height_(height) {}

  // In order of time, against the first frame. A rotation has no such limit and is left as it is.
  FrameMotion next(FrameMotion motion);

 private:
  int width_;
  int height_;
  std::optional<FrameMotion> last_;
};

// The same for all frames of a clip.
std::vector<FrameMotion> within_reach(std::vector<FrameMotion> against_first,
                                      int width,
                                      int height);

// Measured motion in a cache. The motion of a frame depends on earlier frames only, so the motion
// of a longer clip also serves a shorter one.
struct CacheKey {
  std::string video_sha256;
  std::string mask_sha256;  // "" without a mask
  std::int64_t first_frame = 0;
  std::int64_t frame_count = -1;  // -1: to the end
  std::string lens;               // the lens's parameters as text; "" for the model homography
  Options options;
  // Of numbered pictures, whose times follow from it; empty for a video.
  std::optional<double> picture_rate_hz = {};
  // Everything but frame_count.
  disk_cache::Key entry() const;
};

// The motion of exactly the frames of the key. Empty where the cache does not hold all of them.
std::optional<std::vector<FrameMotion>> cached(const disk_cache::Cache& cache, const CacheKey& key);
// Adds a frame to the form in which motion is kept: 56 bytes for a rotation, 96 for a homography.
// The frames of a clip are of one model, in order.
void pack(const FrameMotion& motion, std::string& packed);
// Keeps packed motion, unless the cache already holds more frames for this key.
void store(const disk_cache::Cache& cache, const CacheKey& key, std::string packed);
void store(const disk_cache::Cache& cache,
           const CacheKey& key,
           const std::vector<FrameMotion>& motion);

}  // namespace airtruth::motion
