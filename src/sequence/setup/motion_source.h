// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "camera/gyro/gyro.h"
#include "camera/lens/lens.h"
#include "camera/motion/estimator.h"
#include "camera/motion/motion.h"
#include "foundation/base/files.h"
#include "foundation/base/log.h"
#include "foundation/disk_cache/disk_cache.h"
#include "foundation/image/layer.h"
#include "picture/video/reader.h"
#include "scene/scene/scene.h"

// Provides the homography of each frame from one of three sources: the cache, a preceding pass over
// the clip, or an estimator that runs frame by frame.
namespace airtruth::setup {

class SharedInputs;

// SHA-256 of a file's bytes, or over the names and bytes of numbered pictures; "" for neither.
std::string sha256_of_video(const fs::path& video, SharedInputs& inputs);

// The files that a scene reads, as scene::stated_files(), with the pictures of each series.
std::vector<fs::path> files_read(const scene::Scene& scene);

// Text with every number of a lens, so that two lenses never share an entry of the cache.
std::string words_of(const lens::Lens& lens);

// What the motion of a scene's frames depends on.
struct MotionInputs {
  const scene::Scene& scene;
  const lens::Lens& lens;
  // next() must know how the shake continues within a frame. This needs the following frame, and
  // therefore a preceding pass.
  bool needs_change = false;
  std::string video_sha256;           // "": no cache
  const image::Mask* mask = nullptr;  // of the own aircraft
  disk_cache::Cache cache;
};

// A preceding pass over all frames of the clip.
struct MotionPass {
  bool for_all = false;  // the motion of every frame must be known ahead, whatever the model needs
  std::function<video::Reader()> open;
  std::stop_token stop;
  std::function<void(std::int64_t)> seen;  // called after each frame; may be empty
};

class MotionSource {
 public:
  // The model kNone gives the identity for every frame. Makes the pass where it is required
  // (reference kSmoothed, a shutter, a gyroscope, or `for_all`) and the cache does not hold its
  // result. Throws Interrupted on stop.
  MotionSource(const MotionInputs& inputs, const MotionPass& pass);

  // The motion that an earlier run has measured; empty where the cache does not hold it.
  static std::optional<MotionSource> from_cache(const MotionInputs& inputs);

  // The motion of all frames of a scene, which are in memory. The cache of `inputs` is not used.
  static MotionSource of_frames(MotionInputs inputs, std::span<const video::Frame> frames);

  // Frames in order.
  struct Measured {
    motion::FrameMotion motion;
    Shake shake;
  };
  Measured next(const video::Frame& frame);
  // Frame k, where all are known.
  Measured at(std::size_t k) const;
  // The frame nearest to a time; only where all are known ahead and the clip has a frame.
  Measured nearest(double time_s) const;
  // Stores what next() has measured for the next run, after the last frame. A pass stores its own.
  void store();
  // The motion of every frame; empty where it is not known ahead.
  const std::vector<motion::FrameMotion>& all() const& { return all_; }
  std::vector<motion::FrameMotion> all() && { return std::move(all_); }
  bool has_gyro() const { return !gyro_.empty(); }
  // How the gyroscope agrees with the motion of every frame; empty where it does not.
  const std::optional<gyro::GyroFit>& gyro_fit() const { return gyro_fit_; }

 private:
  explicit MotionSource(const MotionInputs& inputs);
  bool needs_pass(bool for_all) const {
    return !ready_ && (for_all || (!none_ && (smoothed_ || needs_change_ || !gyro_.empty())));
  }
  void measure(const MotionPass& pass);
  void set_pass(std::vector<motion::FrameMotion> against_first);
  motion::FrameMotion measured(const video::Frame& frame);

  motion::Estimator estimator() const;

  bool none_ = false;
  bool needs_change_ = false;
  std::vector<gyro::GyroSample> gyro_;  // bridges what cannot be measured; empty: none
  std::optional<gyro::GyroFit> gyro_fit_;
  std::optional<lens::Lens> lens_;  // of the model rotation
  bool smoothed_ = false;
  bool ready_ = false;  // all_ holds every frame
  disk_cache::Cache cache_;
  motion::Options options_;
  motion::CacheKey key_;
  const image::Mask* mask_;
  lens::ImageSize size_;
  motion::ReachGuard guard_;  // of motion against the first frame
  std::optional<motion::Estimator> estimator_;
  std::string against_first_;  // what next() has measured, packed for the cache
  std::vector<motion::FrameMotion> all_;
};

// The motion of a whole clip by itself, as `airtruth motion` measures it.
struct ClipMotionOptions {
  // A rotation needs a lens, a homography knows none; kAuto: whichever fits. kNone is an Error.
  scene::MotionModel model = scene::MotionModel::kAuto;
  fs::path lens;  // calibration; empty: none
  fs::path mask;  // of the own aircraft; empty: none
  // Of numbered pictures, which state none.
  std::optional<double> picture_rate_hz;
  scene::MotionReference reference = scene::MotionReference::kFirstFrame;
  double smoothing_s = 1;
  disk_cache::Cache cache;
  Warn warn;
  std::stop_token stop;
  // `total` is the container's number of frames; 0: unknown.
  std::function<void(std::int64_t done, std::int64_t total)> progress;
};
struct ClipMotion {
  video::StreamInfo info;
  std::optional<lens::Lens> lens;  // of a rotation
  std::vector<motion::FrameMotion> frames;
  std::optional<gyro::GyroFit> gyro;
};
// Throws Error for faults of the options and files, Interrupted on stop.
ClipMotion clip_motion(const fs::path& video, const ClipMotionOptions& options);

// The scene's motion model with kAuto resolved: kRotation, since a scene states its lens, but
// kHomography for kChromaKey, which is the paper's method.
scene::MotionModel motion_model(const scene::Scene& scene);

// Measures the motion of a whole clip against its first frame, as a rotation where a lens is given.
// Calls `seen` after each frame. Throws Interrupted on stop. The index of a long video takes as
// much memory as a third of its motion; the reader is closed before the motion is used.
std::vector<motion::FrameMotion> measure_motion(video::Reader reader,
                                                motion::Estimator estimator,
                                                const std::stop_token& stop,
                                                const std::function<void(std::int64_t)>& seen);

}  // namespace airtruth::setup
