// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>

#include "foundation/base/files.h"
#include "foundation/base/log.h"
#include "foundation/disk_cache/disk_cache.h"

namespace airtruth::setup {
class SharedInputs;
}  // namespace airtruth::setup

namespace airtruth::pipeline {

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
  // Folder of the cache for motion, calibrations and ambient occlusion; empty: the user's own
  // (disk_cache::user_folder).
  fs::path cache;
  // Inputs that runs of one process have in common (sequence/setup/shared_inputs.h); nullptr: this
  // run reads its own.
  std::shared_ptr<setup::SharedInputs> shared;
  // Draws by the matte method and without the clip's codec whatever the scene states: for a
  // preview, which needs no OpenGL.
  bool is_preview = false;
  // The GPU for the OpenGL of the chroma-key method.
  std::optional<int> gpu;
  bool software_gl = false;
  Warn warn;
  std::function<void(const Progress&)> progress;
  std::stop_token stop;
};

}  // namespace airtruth::pipeline
