// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "camera/lens/lens.h"
#include "dataset/catalogue/drawing.h"
#include "scene/scene/scene.h"

// Turns the random values of an encounter into a path in the world.
namespace airtruth::setup {
class SharedInputs;
}  // namespace airtruth::setup

namespace airtruth::catalogue {

// The length and the size of a sequence, as far as they are known.
struct DrawnClip {
  std::int64_t frames = 0;
  double frame_rate_hz = 30;
  lens::ImageSize size{};  // 0: unknown
  // When its frames are shown, on any clock, where the rate varies; else empty.
  std::span<const double> times_s{};

  // Of a frame that the clip has, from its first.
  double time_s(std::int64_t frame) const {
    return times_s.empty() ? static_cast<double>(frame) / frame_rate_hz
                           : times_s[static_cast<std::size_t>(frame)] - times_s.front();
  }
  double duration_s() const {
    return times_s.empty() ? static_cast<double>(frames) / frame_rate_hz
                           : time_s(frames - 1) + 1 / frame_rate_hz;
  }
};

// Gives the intruder the stated path of its encounter, or one that at the meeting moment passes the
// point in the encounter's direction at its range; of one that has a size, at the provisional one.
// The path is straight, or a coordinated turn with the encounter's bank: a helix of radius speed^2
// / (g tan bank) over the ground. It covers the clip and at least one second more. `camera` moves
// with its stated position, velocity and attitude.
void lay_path(scene::Intruder& intruder,
              const Encounter& encounter,
              const scene::Camera& camera,
              const DrawnClip& clip,
              double provisional_range_m);

// Gives an intruder of a scene its final path. Where the encounter has a size, the range is the one
// at which the longest side of the exact box at the meeting moment has that size. The exact box
// bounds the aircraft's silhouette in its attitude at that moment, projected through the scene's
// lens from the nominal camera with an instantaneous shutter. Where the camera is more than
// kLowestFlightM (metres) above the ground (down = 0), the aircraft is at least that high at the
// meeting moment; its elevation is raised if necessary. Throws Error where no range gives the size.
// `shared` gives the aircraft where it is not nullptr.
constexpr double kLowestFlightM = 30;
void meet(scene::Intruder& intruder,
          const scene::Scene& scene,
          const Encounter& encounter,
          const DrawnClip& clip,
          setup::SharedInputs* shared = nullptr);

}  // namespace airtruth::catalogue
