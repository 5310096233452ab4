// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "labels/annotation/truth.h"
#include "picture/video/reader.h"
#include "scene/scene/scene.h"
#include "sequence/frame/masks.h"
#include "sequence/frame/paint.h"
#include "sequence/sequence/resolve.h"
#include "sequence/sequence/sequence.h"
#include "sequence/setup/motion_source.h"
#include "sequence/setup/shared_inputs.h"
#include "sequence/setup/world.h"
#include "sequence/surroundings/ambient.h"

// The way of a frame through a run, from top to bottom: the inputs that are read before the first
// frame, and the stages of one frame. render() runs the stages in a pipeline and writes files;
// FrameByFrame runs them for a caller who takes the frames in memory.
namespace airtruth::sequence {

// What every frame is made from. The painter refers to it, so it is neither copied nor moved.
struct Setting {
  Setting(const StatedScene& stated, const lens::ImageSize& image_size, const Options& options);
  Setting(const Setting&) = delete;
  Setting& operator=(const Setting&) = delete;

  const image::Mask* own_aircraft() const { return mask ? &*mask : nullptr; }

  scene::Scene scene;  // complete once measure() has run: what sequence.json records
  lens::ImageSize size;
  std::optional<image::Mask> mask;
  std::shared_ptr<SharedInputs> inputs;  // of the process, else of this run
  World world;
  std::unique_ptr<Painter> painter;
};

// One frame on its way through the stages: each fills the members of its own.
struct Work {
  video::Frame frame;            // decode; compose changes its picture
  MotionSource::Measured moved;  // locate
  Moment moment;                 // locate
  Ambient ambient;               // locate
  Painted painted;               // draw, compose
  annotation::Frame truth;       // describe
  std::vector<MaskFile> masks;   // describe
};
using WorkPtr = std::shared_ptr<Work>;

class FrameMaker {
 public:
  // Opens and checks all inputs: faults of the user's input are found here, before any long work.
  // `options` must outlive the maker.
  FrameMaker(const scene::Scene& scene, const Options& options);

  // Measures what must be known of the whole clip before its first frame: the exposure, noise and
  // other values that [realism] leaves to the clip, and the motion where it is needed ahead.
  // Decodes the whole clip where these are not in the cache.
  void measure();

  // 1. decode: the next frame of the background; null after the last one, or on stop.
  WorkPtr decode();
  // 2. locate: how the camera moved, where everything is, and the light that falls there. Frames
  // come in order.
  void locate(Work& work);
  // 3. draw: the intruders' light, coverage and depth on the frame's grid. Frames come in any
  // order.
  void draw(Work& work) const;
  // 4. compose: what was drawn is put into the picture. Frames come in order where a codec's mark
  // follows from the frame before (composes_in_order()), else in any order.
  void compose(Work& work);
  // 5. describe: the frame's truth and masks, from the geometry and from what compositing changed.
  void describe(Work& work) const;

  // Keeps the measured motion for the next run, after the last frame.
  void store_motion() const { motion_->store(); }

  // True where draw() and compose() belong to the thread that made this object: OpenGL's context
  // belongs to one thread.
  bool is_of_one_thread() const {
    return setting_.scene.composite.method == scene::CompositeMethod::kChromaKey;
  }
  bool composes_in_order() const { return setting_.painter->is_in_order(); }

  const scene::Scene& scene() const { return setting_.scene; }
  const World& world() const { return setting_.world; }
  const video::Reader& reader() const { return reader_; }
  // The stream with the number of frames that this run makes of it.
  const video::StreamInfo& info() const { return info_; }
  // SHA-256 of the background; known after measure().
  const std::string& video_sha256() const { return video_sha256_; }
  bool motion_is_from_cache() const { return motion_->from_cache(); }

 private:
  const Options& options_;
  video::Reader reader_;
  StatedScene stated_;
  Setting setting_;
  video::StreamInfo info_;
  std::string video_sha256_;
  std::optional<MotionSource> motion_;
  std::optional<AmbientEstimator> ambient_;
};

// The stream with the number of frames that a scene makes of it.
video::StreamInfo used_stream(video::StreamInfo info, const scene::Background& background);

// The frame of a known motion that a moment of [[intruder.seen]] is about. Throws Error where the
// clip has none within a frame's time of it.
FramePose frame_near(const MotionSource& motion,
                     const video::StreamInfo& info,
                     const scene::Seen& seen);

// The folder that keeps the openness of aircraft; empty: none.
fs::path openness_cache(const Options& options);

// A reader of the scene's part of its background.
video::Reader open_background(const scene::Scene& scene, const Options& options);

}  // namespace airtruth::sequence
