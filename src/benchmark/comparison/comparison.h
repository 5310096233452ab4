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

#include "benchmark/comparison/sun.h"
#include "foundation/base/log.h"
#include "foundation/geometry/box.h"
#include "foundation/geometry/transform.h"
#include "world/scene/scene.h"

// Compares an inserted aircraft with a real one, in the same frames of the same clip and at the
// same apparent size: their appearance, and whether a judge can distinguish them (the paper,
// section II.D, Figures 8 to 10).
namespace airtruth::comparison {

namespace fs = std::filesystem;

// A real aircraft's boxes by frame. The file is CSV with a header and the columns frame, x, y,
// width, height (or w, h), with frames from 0. `origin_px` is subtracted from x and y (1 for
// MATLAB's coordinates).
using RealBoxes = std::map<std::int64_t, Box>;
RealBoxes read_boxes(const fs::path& file, double origin_px);

struct Options {
  bool overwrite = false;
  int pairs = 6;  // number of pairs in the figure
  // Search for the attitude, and the type among these (empty: types_to_match(), pose.h), whose
  // silhouette is the real one's, and for the sun under which light and dark are where the real one
  // has them (sun.h); else all three are the scene's.
  bool match = true;
  std::vector<std::string> types;
  // Upward pitch of the camera; light comes from above in the world. Empty: camera_pitch_deg()
  // (place.h).
  std::optional<double> camera_pitch_deg;
  // Upper bound for the frames; 0 means all frames that have a box.
  std::int64_t most_frames = 0;
  Warn warn;
  std::stop_token stop;
  std::function<void(std::int64_t done, std::int64_t total)> progress;
};

// One quantity of both aircraft over the compared frames: its median, and as spread half the span
// of the middle 68 %.
struct Pair {
  std::string name;
  double real = 0, real_spread = 0;
  double made = 0, made_spread = 0;
};

struct Comparison {
  fs::path folder;
  std::int64_t frames = 0;
  std::vector<Pair> pairs;
  struct Pose {
    std::string aircraft;
    // The attitude in the scene, whose camera looks north.
    YawPitchRoll attitude;
    double overlap = 0;  // of both silhouettes, 0..1; and the real one's aspect over ours
    double aspect_ratio = 1;
    // Empty where too little is visible to determine the sun.
    std::optional<SunFit> sun;
  };
  std::optional<Pose> pose;    // set where it was searched
  double colour_distance = 0;  // median Hellinger distance between real and inserted
  // The same distance between the real aircraft and itself half a clip later.
  double colour_distance_within = 0;
};

// Renders the scene's first intruder beside the real one, in each frame that has a box, and leaves
// in `out`: sequence/ (as `render` does), figure.png, pairs.png (the pairs alone), comparison.json,
// comparison.md, patches.csv (what the judge reads). The scene's own path, camera path and motion
// are not used: the intruder goes where the real one goes, beside it where that is free, as large
// as it by what stands out from the sky in both. The boxes may be loose: the aircraft is found
// within them. Nothing runs across a cut of the clip: of its shots the one with most boxes is
// taken. Error where no aircraft stands out within the boxes.
Comparison compare(const fs::path& real,
                   const RealBoxes& boxes,
                   const scene::Scene& scene,
                   const fs::path& out,
                   const Options& options);

// A value with its 95 % interval by bootstrap over the clips.
struct Interval {
  double value = 0, low = 0, high = 0;
};

// A measure over all clips: the medians of the clips' values and of the differences (inserted minus
// real). Clips without the measure are left out.
struct Gap {
  std::string name;
  std::size_t clips = 0;
  double real = 0, made = 0;
  Interval difference;
};

// The judge's result. The judge is boosted trees (OpenCV's ml) on gradient orientations, noise,
// edges and spectrum of patches. Areas under the curve are folded, max(area, 1 - area), because a
// judge that is always wrong distinguishes the two as well as one that is always right. An area of
// 0.5 means that the judge cannot distinguish them. Where a clip has few pairs, chance alone raises
// a folded area above 0.5.
struct Verdict {
  // Applied to each clip in turn and trained on the others.
  Interval across;
  // Trained and applied within a clip, in stretches of time.
  Interval within;
  struct Clip {
    std::string name;
    std::size_t pairs = 0;
    double across = 0.5;  // not folded
    double within = 0.5;  // folded
  };
  std::vector<Clip> clips;
  // What `across` is where no difference is common to the clips: each clip keeps its own, but which
  // of its two aircraft is called real is drawn for each clip. Clips that differ, whatever in, give
  // folded areas far above 0.5, since a judge finds the side of a clip that happens to look like
  // the others. A judge that finds the inserted aircraft finds more than that.
  struct ByChance {
    int draws = 0;
    double mean = 0, least = 0, most = 0;
    int as_high = 0;  // draws that reach the area found
  };
  std::optional<ByChance> by_chance;
  std::vector<std::pair<std::string, double>> telling;  // features, by how much each alone tells
  std::vector<Gap> gaps;
};
// `chance_draws` is the number of draws for by_chance; each takes as long as `across`. 0 means
// none.
Verdict judge(const std::vector<fs::path>& comparisons,
              std::uint64_t seed,
              int chance_draws = 0,
              const std::stop_token& stop = {});

// The verdict as Markdown tables and as JSON.
std::string text_of(const Verdict& verdict);
std::string json_of(const Verdict& verdict);

// A picture (.png, .jpg) of the pairs of all comparisons.
void write_figure(const std::vector<fs::path>& comparisons, const fs::path& file);

}  // namespace airtruth::comparison
