// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "calibration/calibration.h"
#include "calibration/horizon.h"

namespace airtruth::calibration {

// Air and sun from the colours above and below the horizon.
class AirMeter {
 public:
  AirMeter(const lens::Lens& lens,
           const image::Mask* own_aircraft,
           std::optional<double> altitude_m);
  // cam_from_world: north-east-down, with the heading that the caller knows.
  void add(const image::Picture& picture, const Quaternion& cam_from_world);

  using Colour = std::array<Estimate, 3>;
  // The sky just above the horizon: what an endless way through air looks like.
  std::optional<Colour> airlight(std::string& why) const;
  // Per km, from how the ground's colour goes over into the airlight with distance:
  // L(r) = A + (L0 - A) exp(-extinction r). Empty without an altitude, or where it does not show.
  std::optional<Colour> extinction_per_km(std::string& why) const;
  // The sun's azimuth and elevation, degrees: the direction about which the clear sky (its darkest
  // part at each elevation) is brightest.
  struct Sun {
    Estimate azimuth_deg, elevation_deg;
  };
  std::optional<Sun> sun(std::string& why) const;

 private:
  struct Far {
    double range_m;
    image::Rgb linear;
  };
  struct SkySample {
    Vector3 direction;
    double light;
  };
  lens::Lens lens_;
  const image::Mask* own_aircraft_;
  std::optional<double> altitude_m_;
  std::vector<image::Rgb> above_;
  std::vector<Far> below_;
  std::vector<SkySample> sky_;
};

}  // namespace airtruth::calibration
