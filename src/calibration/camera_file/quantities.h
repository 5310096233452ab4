// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <string_view>

#include <airtruth/calibration.h>

#include "calibration/measured/measured.h"

// The quantities of a camera file.
//
// Example: of a clip of sky alone,
//
//   quantities.noise_gain.values      -> {{8.9e-05, 9.4e-06}}
//   quantities.point_spread.values    -> {}
//   quantities.point_spread.missing   -> "the clip shows 0 clean straight edges; it takes 12"
//   quantities.at("sensor.noise_gain") is quantities.noise_gain
namespace airtruth::camera_file {

using measured::ColourEstimate;
using measured::Measured;
using measured::NotMeasured;

// One quantity. Its `name` is empty here: kQuantityKeys has it.
struct Quantity : CalibratedQuantity {
  bool is_measured() const { return !values.empty(); }
  // The estimate of a quantity with one; the quantity must be measured.
  const Estimate& value() const { return values.at(0); }
};

// Stores an answer: its value, or the reason why there is none.
void put(Quantity& quantity, const Measured<Estimate>& measured);
void put(Quantity& quantity, const Measured<ColourEstimate>& measured);
// Stores the member `part` of an answer that has several quantities.
template <typename Whole>
void put(Quantity& quantity, const Measured<Whole>& measured, Estimate Whole::*part) {
  put(quantity,
      measured ? Measured<Estimate>((*measured).*part)
               : Measured<Estimate>(NotMeasured{measured.why()}));
}

// Units are those of the keys in a scene file (docs/formats/scene.md).
struct Quantities {
  Quantity exposure;           // s
  Quantity readout;            // s; the direction is Calibration::readout_direction
  Quantity extinction;         // per km; red, green, blue
  Quantity airlight;           // linear light; red, green, blue
  Quantity point_spread;       // px, a standard deviation
  Quantity sharpening;         // amount of the unsharp mask
  Quantity sharpening_radius;  // px, a standard deviation
  Quantity noise_gain;         // variance of linear light per linear light
  Quantity noise_floor;        // variance of linear light
  Quantity noise_correlation;  // px, a standard deviation
  Quantity chroma_spread;      // px of luma, a standard deviation
  Quantity codec_step;         // code values
  Quantity sun_azimuth;        // degrees
  Quantity sun_elevation;      // degrees

  // The quantity of a key; throws std::out_of_range for another key.
  Quantity& at(std::string_view key);
  const Quantity& at(std::string_view key) const;
};

// The place of a quantity in a scene file.
struct QuantityKey {
  // Table and key, separated by a dot.
  const char* name;
  // What the value is, for the comments of a camera file.
  const char* words;
  Quantity Quantities::*member;

  std::string_view table() const;
  std::string_view key() const;
};

// All quantities, in the order of a camera file.
inline constexpr std::array<QuantityKey, 14> kQuantityKeys = {{
    {"shutter.exposure_s", "seconds that a row is exposed", &Quantities::exposure},
    {"shutter.readout_s",
     "seconds from the first row to the last; 0: no sign of any",
     &Quantities::readout},
    {"air.extinction_per_km", "red, green, blue", &Quantities::extinction},
    {"air.airlight",
     "linear red, green, blue of the sky just above the horizon",
     &Quantities::airlight},
    {"optics.point_spread_px",
     "standard deviation, with the codec's softness in it",
     &Quantities::point_spread},
    {"optics.sharpening", "amount of the unsharp mask", &Quantities::sharpening},
    {"optics.sharpening_px", "and its standard deviation", &Quantities::sharpening_radius},
    {"sensor.noise_gain", "variance of linear light is gain x light ...", &Quantities::noise_gain},
    {"sensor.noise_floor", "... + floor", &Quantities::noise_floor},
    {"sensor.noise_correlation_px",
     "white noise under a Gaussian of this width",
     &Quantities::noise_correlation},
    {"sensor.chroma_spread_px",
     "standard deviation that chroma has beyond luma's",
     &Quantities::chroma_spread},
    {"sensor.codec_step", "of the quantiser, in code values", &Quantities::codec_step},
    {"light.sun_azimuth_deg",
     "from north, if the heading given was the camera's",
     &Quantities::sun_azimuth},
    {"light.sun_elevation_deg", "above the horizon", &Quantities::sun_elevation},
}};

}  // namespace airtruth::camera_file
