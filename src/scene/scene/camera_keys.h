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
// [optics] and [sensor]. Reading, writing, calibration and a data set's card follow it. A new key
// is a field of CameraModel, a row here and in docs/formats/scene.md, the code that uses the value
// and, where a clip shows the quantity, the code that measures it.
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
  // True where calibration measures the quantity; else it is only stated, and never "auto".
  bool is_measured = false;
  IfUnmeasured if_unmeasured = IfUnmeasured::kError;
  // The other key of the same table that excludes this one.
  std::string_view excluded_by;
  // The effect on the intruder, as a data set's card names it, where the value is above 0. Empty:
  // the key makes no effect of its own.
  std::string_view effect;

  constexpr std::string_view table() const {
    return std::string_view(name).substr(0, std::string_view(name).find('.'));
  }
  constexpr std::string_view key() const {
    return std::string_view(name).substr(std::string_view(name).find('.') + 1);
  }
};

// The tables, in the order of files.
inline constexpr std::array<const char*, 4> kCameraTables = {"shutter", "air", "optics", "sensor"};

// The keys, table by table in the order of files.
inline constexpr auto kCameraModelKeys = std::to_array<CameraKey>({
    {.name = "shutter.exposure_s",
     .member = &CameraModel::exposure_s,
     .limits = kExposureTime,
     .is_measured = true,
     .effect = "motion blur of the exposure"},
    {.name = "shutter.angle_deg",
     .member = &CameraModel::angle_deg,
     .limits = kShutterAngle,
     .excluded_by = "exposure_s",
     .effect = "motion blur of the exposure"},
    {.name = "shutter.readout_s",
     .member = &CameraModel::readout_s,
     .limits = kExposureTime,
     .is_measured = true,
     .effect = "rolling shutter"},
    {.name = "shutter.readout", .member = &CameraModel::readout},
    {.name = "air.extinction_per_km",
     .member = &CameraModel::extinction_per_km,
     .limits = kExtinction,
     .is_measured = true,
     .effect = "haze"},
    {.name = "air.airlight",
     .member = &CameraModel::airlight,
     .limits = kLinearLight,
     .is_measured = true},
    {.name = "optics.point_spread_px",
     .member = &CameraModel::point_spread_px,
     .limits = kSpread,
     .is_measured = true,
     .effect = "point spread"},
    {.name = "optics.vertical_spread_px",
     .member = &CameraModel::vertical_spread_px,
     .limits = kSpread,
     .is_measured = true,
     .if_unmeasured = IfUnmeasured::kLeftOut},
    {.name = "optics.sharpening",
     .member = &CameraModel::sharpening,
     .limits = kSharpening,
     .is_measured = true,
     .effect = "sharpening"},
    {.name = "optics.sharpening_px",
     .member = &CameraModel::sharpening_px,
     .limits = kSpread,
     .is_measured = true},
    {.name = "sensor.noise_gain",
     .member = &CameraModel::noise_gain,
     .limits = kVariance,
     .is_measured = true,
     .effect = "sensor noise"},
    {.name = "sensor.noise_floor",
     .member = &CameraModel::noise_floor,
     .limits = kVariance,
     .is_measured = true,
     .effect = "sensor noise"},
    {.name = "sensor.noise_correlation_px",
     .member = &CameraModel::noise_correlation_px,
     .limits = kSpread,
     .is_measured = true},
    {.name = "sensor.chroma_spread_px",
     .member = &CameraModel::chroma_spread_px,
     .limits = kSpread,
     .is_measured = true,
     .if_unmeasured = IfUnmeasured::kLeftOut,
     .effect = "soft chroma"},
    {.name = "sensor.codec_step",
     .member = &CameraModel::codec_step,
     .limits = kCodecStep,
     .is_measured = true,
     .if_unmeasured = IfUnmeasured::kLeftOutWithAuto,
     .effect = "the codec's quantiser"},
    {.name = "sensor.gamma",
     .member = &CameraModel::gamma,
     .limits = kGamma,
     .effect = "a tone curve other than sRGB's"},
});

// Calls visit(name, member of each model) for every key that calibration can measure on a clip:
// those that may be "auto".
template <typename Visit, typename... Models>
void for_each_camera_key(const Visit& visit, Models&... models) {
  for (const CameraKey& key : kCameraModelKeys)
    std::visit(
        [&]<typename Member>(Member member) {
          if constexpr (!std::is_same_v<Member, CameraKey::Direction>)
            if (key.is_measured) visit(key.name, models.*member...);
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
         std::ranges::any_of(kCameraModelKeys, [&](const CameraKey& key) {
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
  return std::ranges::any_of(values, [](double value) { return value > 0; });
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
  return std::ranges::any_of(
      kWeatherKeys, [&](const WeatherKey& key) { return (weather.*key.member).has_value(); });
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
