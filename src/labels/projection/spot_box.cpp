// SPDX-License-Identifier: Apache-2.0
#include "labels/projection/spot_box.h"

#include <algorithm>
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

// When the row of the spot's middle is exposed.
double row_time_s(const image::Spot& spot, const Shutter& shutter, int width, int height) {
  if (shutter.readout_s <= 0) return 0;
  double dt_s = 0;
  // Number of rounds. Each multiplies the error by the share of the image that the spot crosses
  // during a readout.
  constexpr int kRounds = 6;
  for (int round = 0; round < kRounds; ++round) {
    const Pixel at = spot.centre + dt_s * spot.velocity_px_s;
    dt_s = shutter.middle_s(
        {std::clamp(at.x(), 0.0, double(width)), std::clamp(at.y(), 0.0, double(height))},
        width,
        height);
  }
  return dt_s;
}

}  // namespace

Box spot_box(const image::Spot& spot, const Shutter& shutter, int frame_width, int frame_height) {
  const Box outline = outline_about_centre(spot);
  const double middle_s = row_time_s(spot, shutter, frame_width, frame_height);
  BoxBounds bounds;
  for (const double share : {-0.5, 0.5}) {
    const Pixel at = spot.centre + (middle_s + share * shutter.exposure_s) * spot.velocity_px_s;
    bounds.add(at + Pixel(outline.x, outline.y));
    bounds.add(at + Pixel(outline.right(), outline.bottom()));
  }
  return *bounds.box();
}

}  // namespace airtruth::projection
