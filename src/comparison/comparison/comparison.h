// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "comparison/match/pose.h"
#include "comparison/match/real.h"
#include "comparison/match/sun.h"
#include "foundation/base/files.h"
#include "foundation/base/log.h"
#include "foundation/geometry/box.h"
#include "foundation/geometry/transform.h"
#include "scene/scene/scene.h"

// Compares an inserted aircraft with a real one, in the same frames of the same clip and at the
// same apparent size (the paper, section II.D, Figures 8 to 10).
namespace airtruth::comparison {

struct Options {
  bool overwrite = false;
  int pairs = 6;  // number of pairs in the figure
  // Search for the attitude, and the type among these (empty: types_to_match(helicopter),
  // match/pose.h), whose silhouette is the real one's, and for the sun under which light and dark
  // are where the real one has them (match/sun.h); else all three are the scene's.
  bool match = true;
  std::vector<std::string> types;
  bool helicopter = false;  // the real aircraft is one
  // Upward pitch of the camera; light comes from above in the world. Empty: camera_pitch_deg()
  // (match/place.h).
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
  // Set where it was searched. The attitude is that in the scene, whose camera looks north.
  std::optional<match::PoseFit> pose;
  // Empty where it was not searched, and where too little is visible to determine it.
  std::optional<match::SunFit> sun;
  double colour_distance = 0;  // median Hellinger distance between real and inserted
  // The same distance between the real aircraft and itself half a clip later.
  double colour_distance_within = 0;
};

// Renders the scene's first intruder beside the real one, in each frame that has a box, and leaves
// in `out`: sequence/ (as `render` does), figure.png, comparison.json, comparison.md, and of each
// frame patches/FRAME.png (both crops, the real one at the left) and its lines of patches.csv. The
// scene's own path, camera path and motion are not used: the intruder goes where the real one goes,
// beside it where that is free, as large as it by what stands out from the sky in both. The boxes
// may be loose: the aircraft is found within them. Nothing runs across a cut of the clip: of its
// shots the one with most boxes is taken. Error where no aircraft stands out within the boxes.
Comparison compare(const fs::path& real,
                   const match::RealBoxes& boxes,
                   const scene::Scene& scene,
                   const fs::path& out,
                   const Options& options);

}  // namespace airtruth::comparison
