// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "camera/lens/lens.h"
#include "foundation/geometry/transform.h"
#include "foundation/geometry/within_frame.h"
#include "foundation/image/layer.h"
#include "foundation/image/picture.h"

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
// and roll (horizon_hold.h).
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
  // Homographies only: the camera has turned so far from the first frame that no plane map holds
  // both pictures (reach.h). The motion is that of the last frame within reach.
  kTurnedAway,
};
// The name of a state in motion.csv: "reference", "measured", "bridged", "cut" or "turned_away".
const char* name(State state);

// Whether the motion of a frame in this state is known. Otherwise it is taken from other frames.
inline bool is_known(State state) {
  return state == State::kReference || state == State::kMeasured;
}

struct FrameMotion {
  std::int64_t frame = 0;
  double time_s = 0;
  // p_in_frame ~ H p_in_reference, in airtruth's pixels (corner origin), h33 = 1. The reference is
  // the first frame for Reference::kFirstFrame, and the smoothed camera path for kSmoothed. The map
  // is the identity for the model rotation.
  Homography frame_from_reference = Homography::Identity();
  // cam_from_reference_cam of the model rotation; empty for the model homography.
  std::optional<Quaternion> rotation;
  int inliers = 0;
  // The root mean square reprojection error of the inliers, in pixels of the frame.
  double rms_px = 0;
  State state = State::kReference;
};

enum class Reference { kFirstFrame, kSmoothed };

struct Options {
  int max_corners = 320;
  // The least distance between two corners; 0 derives it from the size of the image.
  double min_corner_distance_px = 0;
  // The largest distance between a corner and its position after tracking forth and back.
  double forward_backward_px = 0.5;
  // The largest reprojection error of an inlier.
  double ransac_px = 1.0;
  // A frame with fewer inliers is not measured.
  int min_inliers = 12;
  // For kSmoothed: the standard deviation of the Gaussian window over time.
  double smoothing_s = 1.0;
  // The seed of RANSAC's random samples.
  std::uint64_t seed = 1;
};

// Measures the motion frame by frame, in order. Its memory does not grow with the number of frames.
// Only one thread at a time may use an Estimator.
class Estimator {
 public:
  // Model homography.
  Estimator(int width,
            int height,
            const Options& options,
            const image::Mask* own_aircraft = nullptr);
  // Model rotation.
  Estimator(const lens::Lens& lens,
            const Options& options,
            const image::Mask* own_aircraft = nullptr);
  ~Estimator();
  Estimator(Estimator&&) noexcept;
  // The motion of the next frame against the first frame. The model homography reads the luma plane
  // alone. A `damaged` frame is bridged. A frame that begins a shot (foundation/image/cuts.h) is a
  // cut, unless most corners are tracked into it; this happens when an object suddenly covers a
  // part of the view.
  FrameMotion next(const image::Picture& picture,
                   double time_s,
                   bool damaged = false,
                   bool begins_shot = false);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// The motion of each frame against a Gaussian-smoothed camera path, which is the shake, from the
// motion against the first frame. The function needs all frames at once (a few hundred bytes each).
std::vector<FrameMotion> smoothed(const std::vector<FrameMotion>& against_first,
                                  const Options& options);

// The shake of frame k and its change per second, from the neighbouring frames. Motion blur and a
// rolling shutter are computed from it.
Shake shake_of(const std::vector<FrameMotion>& motion, std::size_t k);

// The text of motion.csv, and back. The columns are frame,time_s,h11,...,h33,inliers,rms_px,state
// for homographies and frame,time_s,qw,qx,qy,qz,inliers,rms_px,state for rotations. Numbers
// round-trip exactly.
std::string csv_from_motion(const std::vector<FrameMotion>& motion);
std::vector<FrameMotion> motion_from_csv(std::string_view text, const std::filesystem::path& name);

}  // namespace airtruth::motion
