// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <memory>
#include <optional>

#include "camera/lens/lens.h"
#include "labels/annotation/truth.h"
#include "picture/video/reader.h"
#include "scene/scene/scene.h"
#include "sequence/pipeline/options.h"

namespace airtruth::pipeline {

// Makes the frames of a scene one after the other, in memory. The pictures and the truth are those
// that render() writes.
//
// Example: a scene over a clip of 322 frames.
//   FrameByFrame frames(scene::read_scene("scene.toml"), {});
//   while (const auto made = frames.next()) ...    322 times
//
// Frames are made ahead, as many at a time as there are threads (Options::threads), and handed out
// in order; memory is bounded by these frames. Options::overwrite is ignored, and
// Options::progress counts the frames that were handed out.
class FrameByFrame {
 public:
  struct Made {
    video::Frame frame;  // with the intruders in its picture
    annotation::Frame truth;
  };

  // Reads the inputs and measures what must be known of the whole clip. Throws Error for faults in
  // the user's input, and Interrupted after options.stop.
  FrameByFrame(const scene::Scene& scene, const Options& options);
  ~FrameByFrame();

  // Empty after the last frame. Throws Interrupted after options.stop. With the method chroma-key
  // all calls, the constructor's too, belong to one thread.
  std::optional<Made> next();

  // The stream of the background, with the number of frames that this scene makes of it.
  const video::StreamInfo& info() const;
  const lens::Lens& lens() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace airtruth::pipeline
