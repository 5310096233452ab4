// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "foundation/base/log.h"
#include "world/scene/scene.h"

// One video end to end: read, move, render, composite, annotate, write.
namespace airtruth::sequence {

namespace fs = std::filesystem;

struct Progress {
  std::int64_t frames_done = 0;
  std::int64_t frames_total = 0;    // 0: unknown
  const char* stage = "rendering";  // or "measuring the camera"
};

struct Options {
  bool overwrite = false;
  int threads = 0;  // 0: one per core. The annotation's bytes do not depend on it.
  bool use_cache = true;
  fs::path cache;  // of motion and calibrations; empty: the user's own (foundation/base/files.h)
  std::optional<int> gpu;  // for chroma-key's OpenGL
  bool software_gl = false;
  Warn warn;
  std::function<void(const Progress&)> progress;
  std::stop_token stop;
};

// Where the time of a run went: seconds inside each stage, summed over its frames. The stages
// overlap, so that their sum is more than the wall time. The codecs' own threads are not in it,
// only the wait for them.
struct StageSeconds {
  double read = 0;       // decode
  double move = 0;       // the camera's motion, the light around the intruder, where everything is
  double render = 0;     // the intruder's rays
  double composite = 0;  // into the picture, and its truth
  double write = 0;      // encode, truth.jsonl, preview
};

struct Summary {
  fs::path folder;  // <out>/<name>
  std::int64_t frames = 0;
  std::int64_t frames_visible = 0;  // at least one intruder visible
  std::int64_t frames_bridged = 0;  // motion not measured
  std::int64_t frames_damaged = 0;
  double seconds = 0;  // of the frames: without opening the inputs and loading the aircraft
  StageSeconds stages;
  bool motion_from_cache = false;
};

// Leaves <out>/<name>/ whole (docs/formats/output.md) or not at all: everything is written in a
// hidden folder beside it and renamed at the end. Throws Error for what the user gave, Interrupted
// after options.stop.
Summary render(const scene::Scene& scene, const fs::path& out, const Options& options);

// Measures the motion of the scene's background and leaves it in the cache, where the cache does
// not hold it already.
void measure_ahead(const scene::Scene& scene, const Options& options);

// Does the scene ask for values of its camera that neither it nor its camera file states? They are
// measured on the whole clip, whatever part of it the scene uses.
bool needs_calibration(const scene::Scene& scene);

// Calibrates the scene's background and leaves the result in the cache, where the cache does not
// hold it already. Nothing where the scene does not need it.
void calibrate_ahead(const scene::Scene& scene, const Options& options);

}  // namespace airtruth::sequence
