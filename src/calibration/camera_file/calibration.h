// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <airtruth/calibration.h>

#include "calibration/measured/measured.h"
#include "calibration/optics/step_response.h"
#include "calibration/sensor/noise.h"
#include "camera/lens/lens.h"
#include "foundation/base/files.h"
#include "foundation/image/picture.h"
#include "foundation/image/tone_curve.h"
#include "scene/scene/scene.h"

// The camera model and the air of a scene as they were measured, and the text of camera.toml. These
// are the values of scene::CameraModel. Each value has a standard error, or the reason why the clip
// does not show it.
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
  Quantity vertical_spread;    // px, a standard deviation
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
inline constexpr std::array<QuantityKey, 15> kQuantityKeys = {{
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
    {"optics.vertical_spread_px",
     "and what columns have beyond rows, as of an interlaced picture made whole",
     &Quantities::vertical_spread},
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

// The result of a calibration.
struct Calibration {
  fs::path video;
  // The number of clips whose measurements were joined into this one (join.h).
  int clips = 1;
  int width = 0;
  int height = 0;
  std::int64_t frames = 0;
  double frame_rate_hz = 0;
  // Frames that begin a new shot. No pair of frames across a cut is used.
  std::vector<std::int64_t> cuts;
  std::string lens;
  // The tone curve of the options.
  image::ToneCurve tone;
  Quantities quantities;
  // The readout time of the frame in seconds with its sign, positive downwards. It is kept whether
  // or not it differs significantly from 0, since join.h and profile.h combine signed values.
  std::optional<Estimate> downwards_s;
  // The direction in which the rows are read: "down" or "up"; empty if no readout is measured.
  std::string readout_direction;
  // If not every frame gives a horizon: the reason why none does, or a remark about the others.
  std::string no_horizon, horizon_note;
  // For each frame, the heading of the camera relative to that in the first frame, degrees. A
  // sequence that begins at a later frame turns the azimuth of the sun by it. Empty without a lens
  // or a horizon; it ends at the first cut.
  std::vector<double> yaw_from_first_deg;
  std::vector<sensor::NoisePoint> noise;
  optics::EdgeProfile edge;
  std::vector<HorizonAttitude> horizons;
  // A frame with its sky tinted, for the plots.
  std::optional<image::Rgb8> sky_picture;
};

// Whether a readout time differs significantly from 0 and so shows a rolling shutter: its magnitude
// exceeds twice its standard error.
inline bool rolls(const Estimate& readout) { return std::abs(readout.value) > 2 * readout.sigma; }

// What is combined with other measurements of a measured quantity of the calibration: of a readout
// the time with its sign, which the quantity has as 0 within two errors.
inline Estimate to_combine(const Calibration& c, const Quantity& quantity) {
  const bool is_signed = &quantity == &c.quantities.readout && c.downwards_s;
  return is_signed ? *c.downwards_s : quantity.value();
}

// The text of camera.toml: the values, with their errors and the reasons for missing values as
// comments.
std::string toml_from(const Calibration& calibration);
// The measured values as the camera model of a scene.
scene::CameraModel model_of(const Calibration& calibration);

// The name and the focal length of a lens, such as "fisheye 562.7 px", for messages and files.
std::string lens_words(const lens::Lens& lens);

}  // namespace airtruth::camera_file
