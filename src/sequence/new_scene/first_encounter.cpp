// SPDX-License-Identifier: Apache-2.0
#include "sequence/new_scene/first_encounter.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "encounter/placement/by_approach.h"
#include "foundation/base/error.h"
#include "sequence/setup/from_scene.h"
#include "sequence/setup/moment.h"

namespace airtruth::new_scene {
namespace {

// An intruder that is nearest later than this begins as a dot of a pixel or two.
constexpr double kMaxApproachS = 12;

// The candidates, as a person would state them. The closest approach is near the end of the part
// that is used, so that the intruder is in front of the camera for most of it.
struct Candidate {
  double cpa_share;  // of the clip's duration, or of kMaxApproachS in a longer clip
  double course_deg;
  double speed_mps;
  double right_m;
};
constexpr std::array<Candidate, 5> kCandidates = {{{0.9, 180, 60, 40},
                                                   {0.9, 150, 60, -30},
                                                   {0.9, 90, 50, -30},
                                                   {0.9, 270, 50, 30},
                                                   {0.95, 180, 45, 20}}};
constexpr double kAboveM = 15;  // how much higher the intruder passes: chosen
constexpr int kSteps = 40;      // moments at which the view is tested

scene::Encounter encounter_of(const Candidate& candidate, double duration_s) {
  return {.cpa_time_s = candidate.cpa_share * std::min(duration_s, kMaxApproachS),
          .cpa_right_m = candidate.right_m,
          .cpa_above_m = kAboveM,
          .course_deg = candidate.course_deg,
          .speed_mps = candidate.speed_mps};
}

// At how many of the moments the intruder's reference point is in the picture; -1 where no path has
// that closest approach.
int moments_in_view(const scene::Encounter& encounter,
                    const lens::Lens& lens,
                    const trajectory::Path& own,
                    double duration_s,
                    const std::function<Shake(double)>& shake_at) {
  try {
    const trajectory::Path path = placement::path_to_approach(encounter, own);
    int count = 0;
    for (int i = 0; i <= kSteps; ++i) {
      const double time_s = std::min(duration_s, kMaxApproachS) * i / kSteps;
      const auto camera = own.at(time_s), state = path.at(time_s);
      if (!camera || !state) continue;
      const auto sight = setup::sight_of(lens, {}, own, *camera, time_s, shake_at(time_s));
      const auto pixel = projection::pixel_from_world(sight, state->position_in_world);
      if (pixel && lens.size().holds(*pixel)) ++count;
    }
    return count;
  } catch (const Error&) {
    return -1;
  }
}

}  // namespace

std::string first_encounter(const lens::Lens& lens,
                            const scene::Camera& camera,
                            double duration_s,
                            const std::function<Shake(double)>& shake_at) {
  const trajectory::Path own = setup::camera_path(camera);
  const Candidate* best = kCandidates.data();
  int most = -2;
  for (const Candidate& candidate : kCandidates) {
    const int count =
        moments_in_view(encounter_of(candidate, duration_s), lens, own, duration_s, shake_at);
    if (count > most) best = &candidate, most = count;
  }
  const scene::Encounter encounter = encounter_of(*best, duration_s);
  return fmt::format(
      "[[intruder]]\n"
      "aircraft = \"c172/g-boix\"                # airtruth aircraft list\n"
      "[intruder.encounter]\n"
      "cpa_time_s = {:<26.1f}# when the two are nearest; the clip lasts {:.1f} s\n"
      "cpa_right_m = {:<25.0f}# where it passes then: right of\n"
      "cpa_above_m = {:<25.0f}# and above the own aircraft\n"
      "course_deg = {:<26.0f}# from the own course: 180 head-on, 90 from the left, 270 from the "
      "right\n"
      "speed_mps = {:<27.0f}# along its path\n",
      encounter.cpa_time_s,
      duration_s,
      *encounter.cpa_right_m,
      encounter.cpa_above_m,
      encounter.course_deg,
      encounter.speed_mps);
}

Stretch steady_stretch(const std::vector<motion::FrameMotion>& motion,
                       double turn_rad,
                       std::size_t most) {
  const auto rotation = [&](std::size_t k) {
    return motion[k].rotation.value_or(Quaternion::Identity());
  };
  Stretch longest;
  for (std::size_t first = 0; first < motion.size() && longest.frames < most; ++first) {
    const Quaternion at_first = rotation(first);
    std::size_t end = first + 1;
    while (end < motion.size() && end - first < most && motion[end].state != motion::State::kCut &&
           at_first.angularDistance(rotation(end)) <= turn_rad)
      ++end;
    if (end - first > longest.frames) longest = {first, end - first};
  }
  return longest;
}

}  // namespace airtruth::new_scene
