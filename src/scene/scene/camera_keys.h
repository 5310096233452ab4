// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

#include "scene/scene/limits.h"
#include "scene/scene/scene.h"

// The one table of the realism keys: what a scene and a camera file can state in [shutter], [air],
// [optics] and [sensor]. Reading, writing, calibration, a data set's card and the table in
// docs/formats/scene.md follow it. A new key is a field of CameraModel, a row here, the code that
// uses the value and, where a clip shows the quantity, the code that measures it.
//
// Example: the row "sensor.codec_step" makes `codec_step = 8` of [sensor] a number from 0 to 128 in
// CameraModel::codec_step. `codec_step = "auto"` leaves the member empty and adds
// "sensor.codec_step" to CameraModel::automatic.
namespace airtruth::scene {

// The word of a scene file that asks for a measured value.
inline constexpr const char* kAutomaticWord = "auto";

// What happens where [realism] or "auto" asks for a value that the clip does not show.
enum class IfUnmeasured {
  kError,
  kLeftOut,          // with a warning: many clips do not show it
  kLeftOutWithAuto,  // with a warning where [realism] auto = true asks for it; else an error
};

struct CameraKey {
  using Number = std::optional<double> CameraModel::*;
  using Colour = std::optional<std::array<double, 3>> CameraModel::*;
  using Direction = std::optional<Readout> CameraModel::*;

  // Table and key, separated by a dot. The key is also the name of the member.
  const char* name;
  std::variant<Number, Colour, Direction> member;
  // Of the number, or of each number of a colour.
  Limits limits{};
  std::string_view unit;
  // How calibration measures the quantity; empty: it is only stated, and never "auto".
  std::string_view measured;
  IfUnmeasured if_unmeasured = IfUnmeasured::kError;
  // The file below src/ that reads the member for rendering.
  std::string_view read_by;
  // The other key of the same table that excludes this one.
  std::string_view excluded_by;
  // The effect on the intruder, as a data set's card names it, where the value is above 0. Empty:
  // the key makes no effect of its own.
  std::string_view effect;
  std::string_view meaning;

  constexpr std::string_view table() const {
    return std::string_view(name).substr(0, std::string_view(name).find('.'));
  }
  constexpr std::string_view key() const {
    return std::string_view(name).substr(std::string_view(name).find('.') + 1);
  }
  constexpr bool is_measured() const { return !measured.empty(); }
};

// The tables, in the order of files.
inline constexpr std::array<const char*, 4> kCameraTables = {"shutter", "air", "optics", "sensor"};

// The keys, table by table in the order of files.
inline constexpr auto kCameraModelKeys = std::to_array<CameraKey>({
    {.name = "shutter.exposure_s",
     .member = &CameraModel::exposure_s,
     .limits = kExposureTime,
     .unit = "s",
     .measured = "the detail lost along the motion, against a neighbour at rest",
     .read_by = "sequence/setup/from_scene.cpp",
     .effect = "motion blur of the exposure",
     .meaning = "time for which each row is exposed"},
    {.name = "shutter.angle_deg",
     .member = &CameraModel::angle_deg,
     .limits = kShutterAngle,
     .unit = "degrees",
     .read_by = "sequence/pipeline/resolved_scene.cpp",
     .excluded_by = "exposure_s",
     .effect = "motion blur of the exposure",
     .meaning = "the exposure as a share of the frame interval, which is 360 degrees; excludes "
                "`exposure_s`"},
    {.name = "shutter.readout_s",
     .member = &CameraModel::readout_s,
     .limits = kExposureTime,
     .unit = "s",
     .measured = "the picture's shear against the change of its speed",
     .read_by = "sequence/setup/from_scene.cpp",
     .effect = "rolling shutter",
     .meaning = "time from the first row to the last; 0: a global shutter"},
    {.name = "shutter.readout",
     .member = &CameraModel::readout,
     .read_by = "sequence/setup/from_scene.cpp",
     .meaning = "direction in which rows or columns are read; default `down`. A measured "
                "`readout_s` brings its own"},
    {.name = "air.extinction_per_km",
     .member = &CameraModel::extinction_per_km,
     .limits = kExtinction,
     .unit = "1/km",
     .measured = "the same ground seen again from nearer",
     .read_by = "sequence/insertion/paint.cpp",
     .effect = "haze",
     .meaning = "extinction of light by the air, for red, green and blue"},
    {.name = "air.airlight",
     .member = &CameraModel::airlight,
     .limits = kLinearLight,
     .unit = "linear light",
     .measured = "what the ground fades to; else the sky at the horizon",
     .read_by = "sequence/insertion/paint.cpp",
     .meaning = "light of the air itself; default: the background around the intruder"},
    {.name = "optics.point_spread_px",
     .member = &CameraModel::point_spread_px,
     .limits = kSpread,
     .unit = "px",
     .measured = "the width of straight, sharp edges",
     .read_by = "sequence/insertion/paint.cpp",
     .effect = "point spread",
     .meaning = "standard deviation of a Gaussian"},
    {.name = "optics.sharpening",
     .member = &CameraModel::sharpening,
     .limits = kSharpening,
     .measured = "the median overshoot of those edges",
     .read_by = "sequence/setup/from_scene.cpp",
     .effect = "sharpening",
     .meaning = "amount of an unsharp mask"},
    {.name = "optics.sharpening_px",
     .member = &CameraModel::sharpening_px,
     .limits = kSpread,
     .unit = "px",
     .measured = "the reach of that overshoot",
     .read_by = "sequence/setup/from_scene.cpp",
     .meaning = "standard deviation of the unsharp mask's Gaussian; default 1"},
    {.name = "sensor.noise_gain",
     .member = &CameraModel::noise_gain,
     .limits = kVariance,
     .measured = "the noise of flat areas over their brightness",
     .read_by = "sequence/setup/from_scene.cpp",
     .effect = "sensor noise",
     .meaning = "variance of linear light x is `noise_gain` x + `noise_floor`"},
    {.name = "sensor.noise_floor",
     .member = &CameraModel::noise_floor,
     .limits = kVariance,
     .measured = "the noise of flat areas over their brightness",
     .read_by = "sequence/setup/from_scene.cpp",
     .effect = "sensor noise",
     .meaning = "variance of the noise in the dark"},
    {.name = "sensor.noise_correlation_px",
     .member = &CameraModel::noise_correlation_px,
     .limits = kSpread,
     .unit = "px",
     .measured = "the correlation of neighbouring samples of that noise",
     .read_by = "sequence/setup/from_scene.cpp",
     .meaning = "standard deviation of the Gaussian over white noise"},
    {.name = "sensor.chroma_spread_px",
     .member = &CameraModel::chroma_spread_px,
     .limits = kSpread,
     .unit = "px",
     .measured = "the width of edges of colour beyond that of luma's",
     .if_unmeasured = IfUnmeasured::kLeftOut,
     .read_by = "sequence/setup/from_scene.cpp",
     .effect = "soft chroma",
     .meaning = "standard deviation of the Gaussian by which chroma is softer than luma"},
    {.name = "sensor.codec_step",
     .member = &CameraModel::codec_step,
     .limits = kCodecStep,
     .unit = "code values",
     .measured = "the quantiser that the clip's decoder reports (H.264)",
     .if_unmeasured = IfUnmeasured::kLeftOutWithAuto,
     .read_by = "sequence/insertion/paint.cpp",
     .effect = "the codec's quantiser",
     .meaning = "step of H.264's quantiser, 0.625 x 2^(QP/6): the inserted picture goes through "
                "libx264 at the nearest whole QP ([decision "
                "17](../decisions/0017-the-codec-is-a-real-encoder.md)); 0: none"},
    {.name = "sensor.gamma",
     .member = &CameraModel::gamma,
     .limits = kGamma,
     .read_by = "sequence/setup/from_scene.cpp",
     .effect = "a tone curve other than sRGB's",
     .meaning = "exponent of the tone curve: sRGB's line near black, then a power; default: sRGB's "
                "own curve"},
});

// Calls visit(name, member of each model) for every key that calibration can measure on a clip:
// those that may be "auto".
template <typename Visit, typename... Models>
void for_each_camera_key(const Visit& visit, Models&... models) {
  for (const CameraKey& key : kCameraModelKeys)
    std::visit(
        [&]<typename Member>(Member member) {
          if constexpr (!std::is_same_v<Member, CameraKey::Direction>)
            if (key.is_measured()) visit(key.name, models.*member...);
        },
        key.member);
}

// The row of that name; nullptr where there is none.
constexpr const CameraKey* camera_key(std::string_view name) {
  for (const CameraKey& key : kCameraModelKeys)
    if (key.name == name) return &key;
  return nullptr;
}

// True where the model states any key, by a value or by "auto".
inline bool states_any_key(const CameraModel& model) {
  return !model.automatic.empty() ||
         std::any_of(kCameraModelKeys.begin(), kCameraModelKeys.end(), [&](const CameraKey& key) {
           return std::visit([&](auto member) { return (model.*member).has_value(); }, key.member);
         });
}

// True where the key's value is a number above 0, or a colour with such a number.
inline bool is_above_zero(const CameraModel& model, const CameraKey& key) {
  if (const auto* number = std::get_if<CameraKey::Number>(&key.member))
    return model.*(*number) && *(model.*(*number)) > 0;
  const auto* colour = std::get_if<CameraKey::Colour>(&key.member);
  if (colour == nullptr || !(model.*(*colour))) return false;
  const std::array<double, 3>& values = *(model.*(*colour));
  return std::any_of(values.begin(), values.end(), [](double value) { return value > 0; });
}

// A key of [weather].
struct WeatherKey {
  const char* name;
  std::optional<double> Weather::*member;
  Limits limits;
};

inline constexpr auto kWeatherKeys = std::to_array<WeatherKey>({
    {"exposure", &Weather::exposure, kExposureChange},
    {"white_balance", &Weather::white_balance, kWhiteBalanceChange},
    {"blur", &Weather::blur, kBlurChange},
    {"noise", &Weather::noise, kBlurChange},
    {"sun_share", &Weather::sun_share, kShare},
});

inline bool states_any_key(const Weather& weather) {
  return std::any_of(kWeatherKeys.begin(), kWeatherKeys.end(), [&](const WeatherKey& key) {
    return (weather.*key.member).has_value();
  });
}

// Koschmieder's visibility, the distance at which a black object keeps 2 % of its contrast to the
// horizon: ln 50 over the extinction.
inline constexpr const char* kVisibilityKey = "visibility_m";
inline double extinction_per_km(double visibility_m) {
  return 1000 * std::log(50.0) / visibility_m;
}

// The keys of weather_facts().
inline std::vector<std::string> weather_names() {
  std::vector<std::string> names = {kVisibilityKey};
  for (const WeatherKey& key : kWeatherKeys) names.emplace_back(key.name);
  return names;
}

// What a scene states of the weather of what it inserts, by key: the visibility where the air has
// an extinction (that of green), and the keys of [weather] that are there. Sequences are filtered
// and results are broken down by these.
inline std::map<std::string, double> weather_facts(const Scene& scene) {
  std::map<std::string, double> facts;
  const auto& extinction = scene.camera_model.extinction_per_km;
  // ln 50 / x is its own inverse.
  if (extinction && (*extinction)[1] > 0)
    facts[kVisibilityKey] = extinction_per_km((*extinction)[1]);
  for (const WeatherKey& key : kWeatherKeys)
    if (const auto& value = scene.weather.*key.member) facts[key.name] = *value;
  return facts;
}

}  // namespace airtruth::scene
