// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "base/log.h"
#include "geometry/box.h"
#include "scene/scene.h"

// The proof: an inserted aircraft beside a real one, in the same frames of the same clip, at the
// same apparent size; what they look like, and whether a judge can tell them apart (the paper,
// section II.D, Figures 8 to 10).
namespace airtruth::comparison {

namespace fs = std::filesystem;

// A real aircraft's boxes by frame. CSV with a header and columns frame, x, y, width, height (or w,
// h), from 0; `origin_px` is taken off x and y (1 for MATLAB's).
using RealBoxes = std::map<std::int64_t, Box>;
RealBoxes read_boxes(const fs::path& file, double origin_px);

struct Options {
  bool overwrite = false;
  int pairs = 6;                 // of the figure
  std::int64_t most_frames = 0;  // 0: all that have a box
  Warn warn;
  std::stop_token stop;
  std::function<void(std::int64_t done, std::int64_t total)> progress;
};

// One number of both, over the frames compared: median and half the span of the middle 68 %.
struct Pair {
  std::string name;
  double real = 0, real_spread = 0;
  double made = 0, made_spread = 0;
};

struct Comparison {
  fs::path folder;
  std::int64_t frames = 0;
  std::vector<Pair> pairs;
  double colour_distance = 0;         // median Hellinger distance, real to inserted
  double colour_distance_within = 0;  // of the real one to itself, half the clip later
};

// Renders the scene's first intruder beside the real one, in each frame that has a box, and leaves
// in `out`: sequence/ (as `render` does), figure.png, comparison.json, comparison.md, patches.csv
// (what the judge reads). The scene's own path, camera path and motion are not used: the intruder
// goes where the real one goes, one and a half patches to its side where that is free. Its attitude
// is the scene's.
Comparison compare(const fs::path& real,
                   const RealBoxes& boxes,
                   const scene::Scene& scene,
                   const fs::path& out,
                   const Options& options);

// The judge: boosted trees (OpenCV's ml) on the patches of all clips but one, asked about that one;
// each clip in turn. Area under the curve with a 95 % interval by bootstrap over the clips. 0.5: it
// cannot tell.
struct Verdict {
  double auc = 0.5;
  double low = 0, high = 1;
  std::vector<std::pair<std::string, double>> by_clip;
  std::vector<std::pair<std::string, double>> telling;  // features, by how much each alone tells
};
Verdict judge(const std::vector<fs::path>& comparisons, std::uint64_t seed);

}  // namespace airtruth::comparison
