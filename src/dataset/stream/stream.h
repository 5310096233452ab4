// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "dataset/catalogue/catalogue.h"
#include "foundation/geometry/box.h"
#include "foundation/image/picture.h"
#include "labels/annotation/truth.h"
#include "scene/scene/scene.h"
#include "sequence/pipeline/options.h"

// Labelled pictures of a catalogue without end, made when they are asked for.
// A sample is a sequence of [stream] `frames` frames at the place of its index (plan.h).
// It depends on the catalogue, the seed and its index alone. It is made by the stages of a run
// (sequence/pipeline/frame_maker.h), so render() of scene() gives the same pictures and truth, but
// for samples that [stream] other_cameras shows otherwise (other_camera.h).
namespace airtruth::stream {

struct Sample {
  std::string background;        // its name
  std::int64_t first_frame = 0;  // in its video
  // How many encounters of real traffic it stands for, as scene::Scene::weight.
  std::optional<double> weight;
  // The part of the frames that the pictures show. Its corner is even.
  PixelBox crop{};
  struct Frame {
    image::Picture picture;   // of the crop alone
    annotation::Frame truth;  // of the whole frame, in its pixels
    // With the catalogue's [stream] masks: of each intruder of the truth, 255 alpha of each pixel
    // of the picture, row by row.
    std::vector<std::vector<std::uint8_t>> masks;
    // Of each intruder of the truth: the bounds of what it covers of the picture, in the picture's
    // pixels, by the rule of the truth's covered_box_px. Empty where it covers nothing.
    std::vector<std::optional<PixelBox>> covered;
  };
  std::vector<Frame> frames;
};

// Threads may use a Stream at the same time.
class Stream {
 public:
  // Passes each warning to options.warn once. Throws Error where the catalogue has a rule or a
  // background that a stream cannot use. Of `options`, overwrite, is_preview, gpu and progress are
  // ignored, and `threads` draw one sample.
  Stream(catalogue::Catalogue catalogue, std::uint64_t seed, pipeline::Options options);
  ~Stream();

  // Throw Error for faults in what the sample needs, and Interrupted after options.stop.
  Sample sample(std::int64_t index) const;
  scene::Scene scene(std::int64_t index) const;
  bool has_masks() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace airtruth::stream
