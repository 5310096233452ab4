// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "camera/lens/lens.h"
#include "foundation/geometry/transform.h"
#include "foundation/image/layer.h"
#include "foundation/image/picture.h"
#include "runners/process/child.h"
#include "runners/results/detections.h"

// The interface that every detector has: built-in ones, a network, an external program.
namespace airtruth::detector {

// How the camera turned from one frame to the next, as measured from the video.
struct CameraTurn {
  // Rotation that carries a direction in the previous frame's camera into this frame's camera.
  Quaternion this_from_previous = Quaternion::Identity();
  // Standard error of that rotation as a shift in the picture, px.
  double error_px = 0;
};

// One frame as a detector receives it.
struct FrameInput {
  std::int64_t index = 0;  // in the sequence, from 0
  double time_s = 0;
  const image::Picture* picture = nullptr;
  // Nothing links the frame to those before it. True for the first frame of the sequence.
  bool begins_shot = false;
  // Empty for the first frame of a shot, and where the motion is unknown (a blank sky, blur).
  std::optional<CameraTurn> turn;
};

// What is known about a sequence before its first frame.
struct SequenceInput {
  std::string name;
  int width = 0;
  int height = 0;
  double frame_rate_hz = 0;
  // The stated lens, or a guess of 60 degrees across where none is stated.
  lens::Lens lens;
  // The mask of the own aircraft, of the pictures' size; null: nothing of it is in view, or nothing
  // is known of it.
  std::shared_ptr<const image::Mask> own_aircraft = nullptr;
};

// A detector of one sequence at a time. begin() is called once for each sequence, then detect() for
// every frame in order.
class Detector {
 public:
  virtual ~Detector() = default;
  // Forgets the previous sequence. Throws process::Failure.
  virtual void begin(const SequenceInput& sequence) = 0;
  // Returns the frame's detections, the highest score first. Throws process::Failure.
  virtual std::vector<results::Detection> detect(const FrameInput& frame) = 0;
  // True where the detector itself leaves out SequenceInput::own_aircraft.
  virtual bool leaves_out_own_aircraft() const { return false; }
  // True where detect() uses FrameInput::turn; the caller measures the motion only then.
  virtual bool needs_motion() const = 0;
  // The least score with which a detection of the sequence may begin a track; empty where the
  // detector has no opinion, and every detection may. Valid after begin().
  virtual std::optional<double> confident_score() const { return {}; }
  // Output of the detector's process other than its answers.
  virtual std::string log() const { return {}; }
};

// A detector that is a program of its own (docs/detector-protocol.md). `command` is one of a shell.
// The limits are from the process's start to its hello, and from a frame's first byte to its
// answer. begin() starts a process for the sequence, and ends one that it started before. A process
// that ends, answers too late, too early or out of order, or sends what the protocol does not know,
// is a process::Failure that says so; it is ended, with all that it started.
std::unique_ptr<Detector> make_external(std::string command, const process::Limits& limits);

}  // namespace airtruth::detector
