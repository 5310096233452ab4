// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "camera/lens/lens.h"
#include "dataset/labelled/labelled_set.h"
#include "foundation/base/log.h"
#include "truth/evaluation/vot.h"
#include "truth/exchange/labels.h"

namespace airtruth::experiment {

// What trackers are held against: one object of a sequence, from the first frame that shows it
// whole to the last that shows it, and what else is known of those frames.
struct TruthClip {
  exchange::Clip clip;
  std::string background;          // file name of the video that it was made over; an import's own
  std::optional<lens::Lens> lens;  // of what was rendered
  // By frame of the clip; empty where the object is not seen or nothing is known.
  std::vector<std::optional<double>> range_m;
  std::vector<std::optional<double>> size_px;   // longer side of the box
  std::vector<std::optional<double>> contrast;  // levels (show/report/thumbnails.h); by add_film()

  // Small JPEGs of some frames, for the page.
  struct Still {
    std::size_t index = 0;  // in clip.frames
    int width = 0;          // of the video's picture
    std::string whole;      // it, at most kWholeWidth wide
    std::string close;      // a square of kCloseSide about the truth; empty without one
    double close_x = 0, close_y = 0, close_px = 0;  // where that square lies in the picture
  };
  static constexpr int kWholeWidth = 400;
  static constexpr int kCloseSide = 200;
  std::vector<Still> stills;

  std::optional<Box> box(std::size_t i) const {
    const auto& labels = clip.frames[i].labels;
    return labels.empty() ? std::nullopt : std::optional(labels.front().box_px);
  }
  evaluation::VotTruth vot() const;
};

// Every object of every sequence, sorted by name, by its covered boxes (LabelledSet::usual_boxes).
std::vector<TruthClip> truths_of(const dataset::LabelledSet& set, const Warn& warn);

// Reads the clip's video once, for the contrast of each frame and `stills` pictures spread over it.
// A clip without a video keeps neither.
void add_film(TruthClip& truth, std::size_t stills, const std::stop_token& stop);

}  // namespace airtruth::experiment
