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
  int pairs = 6;  // of the figure
  // Search for the attitude, and the type among these (empty: types_to_match(), pose.h), whose
  // silhouette is the real one's, and for the sun under which light and dark are where the real one
  // has them (sun.h); else all three are the scene's.
  bool match = true;
  std::vector<std::string> types;
  // How far the camera looks up; light comes from the world's above. Empty: camera_pitch_deg()
  // (place.h).
  std::optional<double> camera_pitch_deg;
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
  struct Pose {
    std::string aircraft;
    YawPitchRoll attitude;  // as it is placed in the scene: the camera looks north
    double overlap = 0;     // of both silhouettes, 0..1; and the real one's aspect over ours
    double aspect_ratio = 1;
    std::optional<SunFit> sun;  // empty where too little is seen to tell
  };
  std::optional<Pose> pose;           // where it was searched
  double colour_distance = 0;         // median Hellinger distance, real to inserted
  double colour_distance_within = 0;  // of the real one to itself, half the clip later
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

// An interval of 95 % by bootstrap over the clips.
struct Interval {
  double value = 0, low = 0, high = 0;
};

// A measure over all clips: the medians of what each clip has, and of the differences, inserted
// less real. Clips that do not have it are left out.
struct Gap {
  std::string name;
  std::size_t clips = 0;
  double real = 0, made = 0;
  Interval difference;
};

// The judge: boosted trees (OpenCV's ml) on gradient orientations, noise, edges and spectrum of
// patches. Areas under the curve are folded, max(area, 1 - area): a judge that is always wrong
// tells the two apart as well as one that is always right. 0.5: it cannot tell; where a clip has
// few pairs, chance alone lifts a folded area above that.
struct Verdict {
  Interval across;  // asked about each clip in turn, trained on the others
  Interval within;  // trained and asked within a clip, in stretches of time
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
// `chance_draws`: of by_chance, each as long as `across` takes; 0: none.
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
