// SPDX-License-Identifier: Apache-2.0
#include "scene/scene/distractor.h"

namespace airtruth::scene {

double usual_size_m(DistractorKind kind) {
  return kind == DistractorKind::kBird ? 1.3 : kind == DistractorKind::kMultirotor ? 0.4 : 0.3;
}

Distractor usual_distractor(DistractorKind kind, double size_m) {
  Distractor distractor;
  distractor.kind = kind;
  distractor.size_m = size_m;
  distractor.flap_hz = shapes::usual_strokes_per_s(size_m);
  if (kind == DistractorKind::kBalloon) distractor.colour = shapes::BalloonShape{}.colour;
  return distractor;
}

LensMark usual_mark(DistractorKind kind) {
  LensMark mark;
  mark.kind = kind;
  if (kind == DistractorKind::kGlint) {
    mark.size_px = mark.length_px = 90;
    mark.softness = 0.8;
    mark.opacity = 0.3;
    mark.colour = {1, 0.96, 0.86};
  } else if (kind == DistractorKind::kInsect) {
    // Nothing of it is in focus.
    mark.size_px = 16;
    mark.length_px = 48;
    mark.softness = 1;
    mark.opacity = 0.6;
    mark.velocity_px_s = {1500, -400};
    mark.end_s = 1;
  }
  return mark;
}

}  // namespace airtruth::scene
