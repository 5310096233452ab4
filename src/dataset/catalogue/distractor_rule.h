// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "aircraft/shapes/shapes.h"
#include "foundation/base/error.h"
#include "scene/scene/distractor.h"
#include "scene/scene/table_reader.h"

// The tables [[distractor]] of a catalogue: what they put into a share of all its sequences, those
// without an aircraft included.
namespace airtruth::dataset {

// Both ends belong to the range.
struct Span {
  double low = 0;
  double high = 0;
};

struct WholeSpan {
  std::int64_t low = 1;
  std::int64_t high = 1;
};

struct DistractorRule {
  scene::DistractorKind kind = scene::DistractorKind::kBird;
  // Of the catalogue's sequences, 0..1.
  double share = 1;
  // How many a sequence of the share gets.
  WholeSpan count;
  // In the air: size of its body (evenly in the logarithm), and where it is at a moment within the
  // clip: the range (evenly in the logarithm) or the longest side of its exact box, and the angles
  // from the boresight. From there it flies straight both ways.
  Span size_m;
  Span range_m{20, 300};
  std::optional<Span> size_px;
  Span azimuth_deg{-30, 30};
  Span elevation_deg{-5, 20};
  Span heading_deg{0, 360};
  Span climb_deg;
  Span speed_mps;
  // Members of a flock (scene/flock.h) and its radius.
  WholeSpan flock;
  Span spread_m{3, 15};
  // Birds.
  std::vector<aircraft::Plumage> plumages;
  Span glide{0, 0.7};
  // On the lens; diameter (evenly in the logarithm), alpha, and the speed of insects.
  Span spot_px;
  Span opacity;
  Span speed_px_s;
  Where where;
};

// Reads the tables. Throws Error with line and column, also for a key that has no effect on the
// kind.
std::vector<DistractorRule> distractor_rules(const scene::TableReader& root);

}  // namespace airtruth::dataset
