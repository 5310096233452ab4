// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "dataset/catalogue/distractor_rule.h"
#include "dataset/catalogue/drawing.h"
#include "dataset/catalogue/meeting.h"
#include "scene/scene/scene.h"

namespace airtruth::dataset {

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
// size. Until the size is known, with size.width 0, the places are provisional and the numbers of
// things right. Throws Error as meet() does. `shared` may be null.
void lay_distractors(scene::Scene& scene,
                     const DrawnDistractors& drawn,
                     const DrawnClip& clip,
                     const lens::ImageSize& size,
                     sequence::SharedInputs* shared);

}  // namespace airtruth::dataset
