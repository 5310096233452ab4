// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "camera/lens/lens.h"
#include "dataset/catalogue/drawing.h"
#include "world/scene/scene.h"

// From what was drawn to a path in the world.
namespace airtruth::dataset {

// The frames that a sequence will have, as far as is known.
struct DrawnClip {
  std::int64_t frames = 0;
  double frame_rate_hz = 30;

  double duration_s() const { return static_cast<double>(frames) / frame_rate_hz; }
};

// Id, aircraft and speed of intruder k (from 0) of a sequence; its path is not laid yet.
scene::Intruder intruder_of(const Drawn& rule, const Encounter& encounter, std::size_t k);

// The meeting moment, on the clip's clock. Where a size was drawn it is the time of a frame, so
// that the truth of that frame has the size.
double meeting_s(const Encounter& encounter, const DrawnClip& clip);

// Lays a path through the point at that range, in the direction that was drawn, at the meeting
// moment: straight, or in a coordinated turn of the bank that was drawn (a helix whose radius is
// speed^2 / (g tan bank) over the ground). It spans the clip and at least a second more. `camera`
// flies as its position, velocity and attitude say.
void lay_path(scene::Intruder& intruder,
              const Encounter& encounter,
              const scene::Camera& camera,
              const DrawnClip& clip,
              double range_m);

// Lays the path of intruder k of a scene for good. Where a size was drawn, the range is the one at
// which the longest side of the exact box at the meeting moment is that size: of all that the
// aircraft's silhouette covers, in its attitude then, through the scene's lens, by the nominal
// camera and with an instant shutter. The aircraft flies no lower than kLowestFlightM above the
// ground (down = 0) at that moment where the camera is higher than that; its elevation is raised
// for it. Error where no range gives the size.
constexpr double kLowestFlightM = 30;
void meet(scene::Scene& scene,
          std::size_t k,
          const Encounter& encounter,
          const DrawnClip& clip,
          const lens::ImageSize& size);

}  // namespace airtruth::dataset
