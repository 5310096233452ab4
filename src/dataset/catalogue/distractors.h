// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "aircraft/shapes/shapes.h"
#include "dataset/catalogue/drawing.h"
#include "foundation/base/error.h"
#include "scene/scene/distractor.h"
#include "scene/scene/scene.h"
#include "scene/scene/table_reader.h"

// The tables [[distractor]] of a catalogue: what they put into a share of all its sequences, those
// without an aircraft included.
namespace airtruth::setup {
class SharedInputs;
}  // namespace airtruth::setup

namespace airtruth::catalogue {

struct DrawnClip;

struct DistractorRule {
  scene::DistractorKind kind = scene::DistractorKind::kBird;
  // Of the catalogue's sequences, 0..1.
  double share = 1;
  // How many a sequence of the share gets.
  WholeRange count;
  // In the air: size of its body (evenly in the logarithm), and where it is at a moment within the
  // clip: the range (evenly in the logarithm) or the longest side of its exact box, and the angles
  // from the boresight. From there it flies straight both ways.
  Range size_m;
  MeetingPlace place{.range_m = {20, 300}};
  Range climb_deg;
  Range speed_mps;
  // Members of a flock (scene/flock.h) and its radius.
  WholeRange flock;
  Range spread_m{3, 15};
  // Birds.
  std::vector<shapes::Plumage> plumages{shapes::Plumage::kGull,
                                        shapes::Plumage::kDark,
                                        shapes::Plumage::kBrown,
                                        shapes::Plumage::kGrey};
  Range glide{0, 0.7};
  // On the lens; diameter (evenly in the logarithm), alpha, and the speed of insects.
  Range spot_px;
  Range opacity;
  Range speed_px_s;
  Where where;
};

// Reads the tables. Throws Error with line and column, also for a key that has no effect on the
// kind.
std::vector<DistractorRule> distractor_rules(const scene::TableReader& root);

// A distractor in the air with its flock, before it has a path.
struct DrawnFlock {
  // id, kind and body.
  scene::Intruder leader;
  // Where it is at its meeting moment.
  Encounter encounter;
  std::int64_t count = 1;
  double spread_m = 0;
  std::uint64_t seed = 1;
};

// A mark on the lens whose place in the picture is still a share of the picture.
struct DrawnMark {
  scene::LensMark mark;
  double across = 0.5, down = 0.5;  // of its middle at the meeting moment
  double meeting_share = 0.5;       // of the clip's time
  double direction_rad = 0;         // of an insect
  double speed_px_s = 0;
};

struct DrawnDistractors {
  std::vector<DrawnFlock> flocks;
  std::vector<DrawnMark> marks;
};

// What the rules put into sequence `index` of a catalogue. It depends on rules, seed and index
// alone. Each rule's sequences are spread evenly over the set (a rotation by an irrational number),
// independently of the other rules and of the sequences without an aircraft.
DrawnDistractors draw_distractors(const std::vector<DistractorRule>& rules,
                                  std::uint64_t seed,
                                  std::int64_t index);

// Puts the distractors into a scene in place of those that it has, over a clip of this length and
// size. Until the size is known, the places are provisional and the numbers of things right. Throws
// Error as meet() does. `shared` may be null.
void lay_distractors(scene::Scene& scene,
                     const DrawnDistractors& drawn,
                     const DrawnClip& clip,
                     setup::SharedInputs* shared);

}  // namespace airtruth::catalogue
