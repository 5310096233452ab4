// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "camera/lens/lens.h"
#include "camera/motion/estimator.h"
#include "camera/motion/motion.h"
#include "dataset/labelled/labelled_set.h"
#include "foundation/base/files.h"
#include "foundation/base/log.h"
#include "picture/video/reader.h"
#include "runners/detector/detector.h"
#include "runners/results/results_folder.h"
#include "sequence/setup/shared_inputs.h"

// What detectors run over.
namespace airtruth::runs {

struct DetectionClip {
  std::string name;
  // A video, a folder or a pattern of numbered images.
  fs::path media;
  video::ReaderOptions reading = {.threads = 1};
  // Numbers of the frames in the video, ascending, counted from the first that is
  // read; empty: all frames.
  std::vector<std::int64_t> frames;
  // Empty where nothing states one.
  std::optional<lens::Lens> lens;
  // A picture that is black where the own aircraft is; empty where nothing states one.
  std::optional<fs::path> own_aircraft;
  // By which the numbers in `frames` follow one another (exchange::frame_step()); the clip's frame
  // rate is the video's over it.
  std::int64_t frame_step = 1;
  // The folder of the sequence whose record names `own_aircraft`; empty where none does.
  fs::path sequence;
  // Of a rendered sequence that of its truth, which its video holds at least; else 0.
  std::int64_t frames_of_truth = 0;
};

// A sequence of a set with all its frames. Throws Error where it has no video.
DetectionClip clip_of(const labelled::LabelledSet& set, const std::string& name);
// The parts of background videos that the given sequences were made over, each once, in the order
// of the sequences: pictures without any intruder of the scene. A part is named as its video, with
// the first frame and the number of frames where it is not the whole ("sky.84-20"), and then with
// "-2" and so on where another video has that name. A video is the one that replay::find_input()
// finds; what is not there any more, or is another file now, is left out with a warning. An
// imported sequence has none.
std::vector<DetectionClip> backgrounds_of(const labelled::LabelledSet& set,
                                          const std::vector<std::string>& names,
                                          setup::SharedInputs& inputs,
                                          const Warn& warn);
// A video as a clip of the name that video::clip_name() gives.
DetectionClip clip_of(const fs::path& video);

// What detections of the set have to fit: every sequence, in the order of the set. The size of the
// pictures is not looked up.
std::vector<results::ExpectedSequence> sequences_of(const labelled::LabelledSet& set);

// A pinhole of 60 degrees across, for clips whose lens nothing states. Between 40 and 90 degrees,
// the rotation that is measured through it moves a pixel by the same amount within some per cent,
// for turns of a few degrees.
lens::Lens guessed_lens(const video::StreamInfo& info);

// The frames of a clip in order, with the camera's turn since the frame before, which is measured
// once for all detectors.
class ClipFrames {
 public:
  // Throws Error where the video cannot be read.
  ClipFrames(const DetectionClip& clip, bool with_motion, const Warn& warn);

  const detector::SequenceInput& sequence() const { return sequence_; }
  const video::StreamInfo& info() const { return reader_.info(); }
  // The next frame of the clip; its picture is valid until the next call. Empty at the end. Throws
  // Error where the video ends before the clip does.
  std::optional<detector::FrameInput> next();
  // 0: unknown.
  std::int64_t count_estimate() const;

 private:
  std::optional<detector::CameraTurn> turn_of(const motion::FrameMotion& motion);

  const DetectionClip& clip_;
  video::Reader reader_;
  detector::SequenceInput sequence_;
  std::optional<motion::Estimator> estimator_;
  std::optional<video::Frame> frame_;
  std::optional<motion::FrameMotion> before_;
  std::int64_t index_ = 0;
};

}  // namespace airtruth::runs
