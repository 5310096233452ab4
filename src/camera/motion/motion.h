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

// How the camera moved: strong corners (Shi and Tomasi 1994) outside the own aircraft, spread over
// the image; pyramidal Lucas-Kanade (Bouguet 2001) with a forward-backward check (Kalal 2010); and
// one of two models of what they tell.
//
// homography (the paper, section II.C): one plane map per frame, by RANSAC (Fischler and Bolles
// 1981) to the key frame, refined on its inliers; new key frames before tracks run thin,
// homographies composed.
//
// rotation: through a known lens corners are bearings, and what is far turns with the camera. One
// rotation per frame by RANSAC and robust least squares; near ground and own aircraft fall out
// (rotation_fit.h). Exact for any lens, where a homography is exact for a pinhole alone. Horizons
// that are seen hold its pitch and roll (horizon_hold.h).
namespace airtruth::motion {

enum class State {
  kReference,  // the first frame: identity by definition
  kMeasured,
  kBridged,  // could not be measured (blank sky, blur, damage); carried on from its neighbours and
             // flagged
  kCut,      // the scene changed: nothing links it to the frames before; carried on and flagged
  kTurnedAway,  // a homography alone: the camera has turned so far from the first frame that one
                // plane does not hold both pictures (reach.h); carried on and flagged
};
// "reference", "measured", "bridged", "cut", "turned_away"
const char* name(State state);

// Whether the state says that the motion is known; else it is carried on from other frames.
inline bool is_known(State state) {
  return state == State::kReference || state == State::kMeasured;
}

struct FrameMotion {
  std::int64_t frame = 0;
  double time_s = 0;
  // p_in_frame ~ H p_in_reference, in airtruth's pixels (corner origin), h33 = 1. For
  // Reference::kFirstFrame the reference is the first frame; for kSmoothed the steady camera that
  // the shaking one follows.
  // Identity for the model rotation.
  Homography frame_from_reference = Homography::Identity();
  // cam_from_reference_cam, of the model rotation; empty for homography.
  std::optional<Quaternion> rotation;
  int inliers = 0;
  double rms_px = 0;  // of the inliers' reprojection, in the frame
  State state = State::kReference;
};

enum class Reference { kFirstFrame, kSmoothed };

struct Options {
  int max_corners = 320;
  double min_corner_distance_px = 0;  // 0: chosen from the image's size
  double forward_backward_px = 0.5;   // largest disagreement of a track with its own way back
  double ransac_px = 1.0;
  int min_inliers = 12;
  double smoothing_s = 1.0;  // kSmoothed: standard deviation of the Gaussian window over time
  std::uint64_t seed = 1;
};

// Frame by frame, in order; memory does not grow with the number of frames. One thread at a time.
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
  // A homography reads the luma plane alone. `damaged` frames are bridged. A frame that begins a
  // shot (foundation/image/cuts.h) is a cut, unless most corners are followed into it, as beside
  // something that suddenly covers a part of the view. Result against the first frame.
  FrameMotion next(const image::Picture& picture,
                   double time_s,
                   bool damaged = false,
                   bool begins_shot = false);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// Splits motion against the first frame into steady camera and shake: returns it
// with the reference following a Gaussian-smoothed camera. All frames are needed at once (a few
// hundred bytes each).
std::vector<FrameMotion> smoothed(const std::vector<FrameMotion>& against_first,
                                  const Options& options);

// The shake of one frame with its change per second, from the frames beside it: what blur and a
// rolling shutter need.
Shake shake_of(const std::vector<FrameMotion>& motion, std::size_t k);

// motion.csv: frame,time_s,h11,...,h33,inliers,rms_px,state, or for rotations
// frame,time_s,qw,qx,qy,qz,inliers,rms_px,state. Numbers round-trip exactly.
std::string csv_from_motion(const std::vector<FrameMotion>& motion);
std::vector<FrameMotion> motion_from_csv(std::string_view text, const std::filesystem::path& name);

}  // namespace airtruth::motion
