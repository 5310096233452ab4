// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "scene/scene/scene.h"
#include "sequence/pipeline/options.h"

// Renders one video from beginning to end: read, move, render, composite, annotate, write.
//
// Example: the demo's scene has 322 frames. If Summary::seconds is 46 after render(), the run
// processed 322 / 46 = 7.0 frames per second. If 3 of the frames have an unmeasured camera motion,
// frames_bridged is 3, and frames is still 322.
namespace airtruth::pipeline {

// Time of a stage in seconds, summed over its frames. The stages overlap, so the sum of their wall
// times exceeds that of the run. CPU time is that of the stage's own thread: the threads of the
// codecs, and those that take a part of an intruder's rays, are in StageTimes::other_threads_cpu_s.
struct StageTime {
  double wall_s = 0;
  double cpu_s = 0;
};

struct StageTimes {
  StageTime read;  // decode
  // The camera's motion, the light around the intruder, and the geometry of the frame.
  StageTime move;
  StageTime render;     // ray tracing of the intruders
  StageTime composite;  // compositing into the picture, and the truth
  StageTime write;      // encode, truth.jsonl, preview
  // CPU time of the process while the frames passed, less that of the stages.
  double other_threads_cpu_s = 0;
  // CPU time of the process before the first frame and after the last one.
  double start_cpu_s = 0;
  double end_cpu_s = 0;
};

// How many frames there were, and of them those of which something is to be said.
struct FrameCounts {
  std::int64_t frames = 0;
  std::int64_t frames_visible = 0;  // with at least one visible aircraft
  std::int64_t frames_bridged = 0;  // whose camera motion was not measured
  std::int64_t frames_damaged = 0;  // whose data in the background was corrupt
};

struct Summary : FrameCounts {
  fs::path folder;  // <out>/<name>
  // Wall time of the frames in seconds, without opening the inputs and loading the aircraft.
  double seconds = 0;
  StageTimes stages;
  // As those of the resolved scene (sequence/pipeline/resolved_scene.h).
  std::vector<std::string> notes;
};

// Writes <out>/<name>/ (docs/formats/output.md) whole or not at all: all files are written to a
// hidden folder beside it, which is renamed at the end. Throws Error for faults in the user's
// input, and Interrupted after options.stop.
Summary render(const scene::Scene& scene, const fs::path& out, const Options& options);

}  // namespace airtruth::pipeline
