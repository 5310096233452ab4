// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include <airtruth/labels.h>

#include "camera/lens/lens.h"
#include "dataset/labelled/labelled_set.h"
#include "runners/results/trajectories.h"
#include "show/drawing/thumbnails.h"

namespace airtruth::tracker_evaluation {

// The truth for one object of a sequence, from the first frame that shows it whole to the last
// frame that shows it, with further facts about those frames.
struct TruthClip {
  exchange::Clip clip;
  // labelled::ClipFacts::background_name.
  std::string background;
  // What is known of the weather of what was inserted (scene::weather_facts()).
  std::map<std::string, double> weather;
  // Set for rendered sequences.
  std::optional<lens::Lens> lens;
  // Contrast in grey levels (foundation/image/contrast_to_noise.h) by frame of the clip, filled in
  // by add_film(). Empty where the object is not visible or the value is unknown, as range_m() and
  // size_px() are.
  std::vector<std::optional<double>> contrast;
  // Some frames, for the page.
  std::vector<drawing::Still> stills;
  // labelled::LabelledSet::sha256_of() of its sequence.
  std::string sha256;
  // Of the first frame among those of the sequence.
  std::int64_t first_place = 0;

  std::optional<Box> box(std::size_t i) const { return results::box_of(clip.frames[i]); }
  std::optional<double> range_m(std::size_t i) const {
    const std::vector<exchange::Label>& labels = clip.frames[i].labels;
    return labels.empty() ? std::nullopt : labels.front().range_m;
  }
  // The longer side of the box.
  std::optional<double> size_px(std::size_t i) const {
    const std::optional<Box> shown = box(i);
    return shown ? std::optional(std::max(shown->width, shown->height)) : std::nullopt;
  }
};

constexpr drawing::CutoutOptions kClose = {
    .surroundings = 3, .most_of_picture = 3, .side = 200, .whole_width = 400, .quality = 8};

// Returns every object of every sequence, sorted by name, with its covered boxes.
std::vector<TruthClip> truths_of(const labelled::LabelledSet& set);

// Reads the clip's video once and fills in the contrast of each frame and `stills` pictures spread
// over the clip. A clip without a video gets neither.
void add_film(TruthClip& truth, std::size_t stills, const std::stop_token& stop);

}  // namespace airtruth::tracker_evaluation
