// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "foundation/base/log.h"
#include "foundation/disk_cache/disk_cache.h"
#include "scene/scene/scene.h"

// Renders one video from beginning to end: read, move, render, composite, annotate, write.
//
// Example: the demo's scene has 322 frames. If Summary::seconds is 46 after render(), the run
// processed 322 / 46 = 7.0 frames per second. If 3 of the frames have an unmeasured camera motion,
// frames_bridged is 3, and frames is still 322.
namespace airtruth::sequence {

class SharedInputs;

namespace fs = std::filesystem;

struct Progress {
  std::int64_t frames_done = 0;
  std::int64_t frames_total = 0;    // 0: unknown
  const char* stage = "rendering";  // or another stage, such as "measuring the camera"
};

struct Options {
  bool overwrite = false;
  // Number of threads that make frames; 0 means one per core. No output's bytes depend on it,
  // unless hardware encodes the video. libx264 has eight threads of its own beside them.
  int threads = 0;
  bool use_cache = true;
  // Folder of the cache for motion, calibrations and openness; empty: the user's own
  // (disk_cache::user_folder).
  fs::path cache;
  // Inputs that runs of one process have in common (sequence/setup/shared_inputs.h); nullptr: this
  // run reads its own.
  std::shared_ptr<SharedInputs> shared;
  // The GPU for the OpenGL of the chroma-key method.
  std::optional<int> gpu;
  bool software_gl = false;
  Warn warn;
  std::function<void(const Progress&)> progress;
  std::stop_token stop;
};

// The part of the cache for one kind of result, "motion" or "calibration".
disk_cache::Cache cache_of(const Options& options, const char* kind);

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

struct Summary {
  fs::path folder;  // <out>/<name>
  std::int64_t frames = 0;
  std::int64_t frames_visible = 0;  // frames with at least one visible intruder
  std::int64_t frames_bridged = 0;  // frames whose motion was not measured
  std::int64_t frames_damaged = 0;
  // Wall time of the frames in seconds, without opening the inputs and loading the aircraft.
  double seconds = 0;
  StageTimes stages;
  bool motion_from_cache = false;
};

// Writes <out>/<name>/ (docs/formats/output.md) whole or not at all: all files are written to a
// hidden folder beside it, which is renamed at the end. Throws Error for faults in the user's
// input, and Interrupted after options.stop.
Summary render(const scene::Scene& scene, const fs::path& out, const Options& options);

// Measures the motion of the scene's background and stores it in the cache, unless the cache holds
// it already.
void measure_ahead(const scene::Scene& scene, const Options& options);

// True where the scene asks for camera values that neither the scene nor its camera file states.
// They are measured on the whole clip, whatever part of it the scene uses.
bool needs_calibration(const scene::Scene& scene);

// Calibrates the scene's background and stores the result in the cache, unless the cache holds it
// already. Does nothing where the scene needs no calibration.
void calibrate_ahead(const scene::Scene& scene, const Options& options);

}  // namespace airtruth::sequence
