// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "labels/annotation/truth.h"
#include "picture/video/reader.h"
#include "scene/scene/scene.h"
#include "sequence/insertion/ambient.h"
#include "sequence/insertion/masks.h"
#include "sequence/insertion/paint.h"
#include "sequence/pipeline/resolved_scene.h"
#include "sequence/setup/moment.h"
#include "sequence/setup/motion_source.h"

// The way of a frame through a run: the stages of one frame, from top to bottom. render() runs the
// stages in a pipeline and writes files; FrameByFrame runs them for a caller who takes the frames
// in memory.
namespace airtruth::pipeline {

// One frame on its way through the stages: each fills the members of its own.
struct Work {
  video::Frame frame;                      // decode; compose changes its picture
  setup::MotionSource::Measured moved;     // locate
  setup::Moment moment;                    // locate
  insertion::Ambient ambient;              // locate
  insertion::Painted painted;              // draw, compose
  annotation::Frame truth;                 // describe
  std::vector<insertion::MaskFile> masks;  // describe
};
using WorkPtr = std::shared_ptr<Work>;

class FrameMaker {
 public:
  // `stop`: decode() returns null, and a layer that is being drawn stays incomplete.
  FrameMaker(ResolvedScene resolved, const std::stop_token& stop);
  FrameMaker(const FrameMaker&) = delete;  // its painter refers to the scene in it
  FrameMaker& operator=(const FrameMaker&) = delete;

  // 1. decode: the next frame of the background; null after the last one, or on stop.
  WorkPtr decode();
  // 2. locate: how the camera moved, where everything is, and the light that falls there. Frames
  // come in order.
  void locate(Work& work);
  // The same with a motion that is known: that of a finished sequence's truth.
  void locate(Work& work, const Shake& shake);
  // 3. draw: the intruders' light, coverage and depth on the frame's grid. Frames come in any
  // order. With chroma-key draw() and compose() belong to the thread that opened the scene, as
  // OpenGL's context does.
  void draw(Work& work) const;
  // 4. compose: what was drawn is put into the picture. Frames come in order where a codec's mark
  // follows from the frame before (composes_in_order()), else in any order.
  void compose(Work& work);
  // 5. describe: the frame's truth and masks, from the geometry and from what compositing changed.
  void describe(Work& work) const;

  // Keeps the measured motion for the next run, after the last frame.
  void store_motion() { resolved_.motion->store(); }

  bool composes_in_order() const { return painter_.is_in_order(); }

  const ResolvedScene& resolved() const { return resolved_; }

 private:
  ResolvedScene resolved_;
  std::stop_token stop_;
  insertion::Painter painter_;
  insertion::AmbientEstimator ambient_;
};

// The threads of an arena in which so many work: no more than oneTBB has, which warns on standard
// error where it is asked for more.
int arena_threads(int wanted);

}  // namespace airtruth::pipeline
