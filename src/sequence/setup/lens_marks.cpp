// SPDX-License-Identifier: Apache-2.0
#include "sequence/setup/lens_marks.h"

#include <algorithm>
#include <cmath>

#include "foundation/base/seed.h"

namespace airtruth::setup {
namespace {

// Standard deviation of the amplitude of a dirt's first lobe; the k-th has a k-th of it. All lobes
// together stay far below 1, so that the outline never meets the centre.
constexpr double kLobeShare = 0.10;
constexpr double kMostLobe = 0.15;

// Wings of an insect as shares of its body's length, about those of a honeybee worker: a body of 13
// mm, a thorax of 4 mm, a forewing of 9.7 mm with a mean chord of 3 mm. A bee beats them 230 times
// a second through 90 degrees (Altshuler et al. 2005, PNAS 102, 18213): from exposures of 1/230 s
// on the whole stroke is one blur.
constexpr double kWingLength = (9.7 + 4.0 / 2) / 13;  // from the middle of the body to a tip
constexpr double kWingRadius = 0.5 * 9.7 * 0.7 / 13;  // half of the stroke's height: chosen
// Half way out the chord of 3 mm sweeps an arc of 7.6 mm, and half of the light goes through the
// wing: chosen.
constexpr double kWingShare = 3 / 7.6 * 0.5;

// Distance at which a point stands for the sun's direction: parallax is below 1e-6 of a pixel.
constexpr double kSunM = 1e12;

std::optional<Pixel> sun_pixel(const projection::Sight& sight, const Vector3& to_sun_in_world) {
  const Rigid world_from_cam = sight.cam_from_world.inverse();
  return projection::pixel_from_world(sight, world_from_cam.translation + kSunM * to_sun_in_world);
}

std::optional<Pixel> axis_pixel(const projection::Sight& sight) {
  const Rigid world_from_cam = sight.cam_from_world.inverse();
  return projection::pixel_from_world(sight, world_from_cam * Vector3(0, 0, kSunM));
}

// A point on the line from the picture of the lens's axis to the sun. Reflections between the
// surfaces of a lens lie on it, whatever the lens (Hullin et al. 2011, "Physically-based real-time
// lens flare rendering", section 3).
std::optional<Pixel> glint_pixel(const scene::LensMark& mark,
                                 const projection::Sight& sight,
                                 const Vector3& to_sun_in_world) {
  const auto sun = sun_pixel(sight, to_sun_in_world);
  const auto axis = axis_pixel(sight);
  if (!sun || !axis) return std::nullopt;
  return Pixel(*axis + mark.along * (*sun - *axis));
}

void add_lobes(image::Spot& spot, Random random) {
  for (std::size_t k = 0; k < image::Spot::kLobes; ++k) {
    const double share = kLobeShare / static_cast<double>(k + 1);
    for (double* lobe : {&spot.cosines[k], &spot.sines[k]})
      *lobe = std::clamp(share * random.normal(), -kMostLobe, kMostLobe);
  }
}

// A number of the whole pixel at which a mark begins, so that marks of one name and of several
// scenes have shapes of their own.
std::uint64_t place_of(const scene::LensMark& mark) {
  const Pixel at = mark.pixel.value_or(Pixel::Zero());
  const auto whole = [](double x) { return static_cast<std::uint64_t>(std::llround(x)); };
  return (whole(at.x()) << 32) ^ (whole(at.y()) & 0xffffffffU);
}

}  // namespace

bool is_there(const scene::LensMark& mark, double time_s) {
  return time_s >= mark.begin_s && (!mark.end_s || time_s <= *mark.end_s);
}

std::optional<image::Spot> spot_of(const scene::LensMark& mark,
                                   const projection::Sight& sight,
                                   const Vector3& to_sun_in_world,
                                   double time_s,
                                   std::uint64_t seed) {
  if (!is_there(mark, time_s)) return std::nullopt;
  image::Spot spot;
  if (mark.pixel) {
    spot.velocity_px_s = mark.velocity_px_s;
    spot.centre = *mark.pixel + (time_s - mark.begin_s) * mark.velocity_px_s;
  } else {
    const auto pixel = glint_pixel(mark, sight, to_sun_in_world);
    if (!pixel) return std::nullopt;
    spot.centre = *pixel;
  }
  spot.radius_px = mark.size_px / 2;
  spot.half_length_px = (mark.length_px - mark.size_px) / 2;
  if (mark.velocity_px_s.norm() > 0) spot.direction = mark.velocity_px_s.normalized();
  spot.softness = mark.softness;
  spot.opacity = mark.opacity;
  for (std::size_t c = 0; c < 3; ++c) spot.colour[c] = static_cast<float>(mark.colour[c]);
  if (mark.kind == scene::DistractorKind::kInsect) {
    spot.wing_radius_px = kWingRadius * mark.length_px;
    spot.wing_px = kWingLength * mark.length_px - spot.wing_radius_px;
    spot.wing_share = kWingShare;
  }
  if (mark.kind == scene::DistractorKind::kDirt)
    add_lobes(spot, Seed(seed).stream("outline of " + mark.id, place_of(mark)));
  return spot;
}

}  // namespace airtruth::setup
