// SPDX-License-Identifier: Apache-2.0
#include "labels/projection/spot_box.h"

#include <cmath>

namespace airtruth::projection {
namespace {

// The outline at half opacity about the spot's centre.
Box outline_about_centre(const image::Spot& spot) {
  // The fade is a cubic that is one half in its middle.
  const double radius_px = spot.radius_px * (1 - 0.5 * spot.softness);
  const Pixel half = Pixel::Constant(radius_px) + spot.half_length_px * spot.direction.cwiseAbs();
  if (spot.half_length_px > 0 || spot.wing_px > 0) {
    // The wings' outline is where their own alpha is half of that in their middle.
    const Pixel across(std::abs(spot.direction.y()), std::abs(spot.direction.x()));
    const Pixel wings =
        spot.wing_px > 0 ? Pixel(Pixel::Constant(0.5 * spot.wing_radius_px) + spot.wing_px * across)
                         : Pixel(Pixel::Zero());
    const Pixel all = half.cwiseMax(wings);
    return {-all.x(), -all.y(), 2 * all.x(), 2 * all.y()};
  }
  // Number of directions: one in half a degree.
  constexpr int kPoints = 720;
  BoxBounds bounds;
  for (int i = 0; i < kPoints; ++i) {
    const double angle = 2 * kPi * i / kPoints;
    const Pixel outwards(std::cos(angle), std::sin(angle));
    bounds.add(radius_px * spot.lobe(outwards.x(), outwards.y()) * outwards);
  }
  return *bounds.box();
}

}  // namespace

Box spot_box(const image::Spot& spot, const Shutter& shutter, int frame_width, int frame_height) {
  const Box outline = outline_about_centre(spot);
  const auto centre_at = [&](double dt_s) -> Pixel {
    return spot.centre + dt_s * spot.velocity_px_s;
  };
  constexpr int kRounds = 6;
  const double middle_s = shutter.seen_s(centre_at, frame_width, frame_height, kRounds);
  BoxBounds bounds;
  for (const double share : {-0.5, 0.5}) {
    const Pixel at = centre_at(middle_s + share * shutter.exposure_s);
    bounds.add(at + Pixel(outline.x, outline.y));
    bounds.add(at + Pixel(outline.right(), outline.bottom()));
  }
  return *bounds.box();
}

}  // namespace airtruth::projection
