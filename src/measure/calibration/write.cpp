// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <map>
#include <type_traits>

#include <fmt/format.h>

#include "measure/calibration/calibration.h"
#include "world/scene/camera_keys.h"

namespace airtruth::calibration {
namespace {

// A number as text, with four significant digits.
std::string shown(double value) { return fmt::format("{:.4g}", value); }

// The origin of the value in words.
std::string source_words(const Calibration& c, const std::string& key) {
  const auto source = c.sources.find(key);
  return source == c.sources.end() ? (c.clips > 1 ? "the clips' own" : "the clip's own")
                                   : source->second;
}

std::string array_of(const std::vector<Estimate>& values, bool errors) {
  std::string text;
  for (const Estimate& e : values)
    text += (text.empty() ? "" : ", ") + shown(errors ? e.sigma : e.value);
  return values.size() == 1 ? text : "[" + text + "]";
}

struct Key {
  const char* table;
  const char* key;
  const char* words;
};

constexpr std::array<Key, 14> kKeys = {{
    {"shutter", "exposure_s", "seconds that a row is exposed"},
    {"shutter", "readout_s", "seconds from the first row to the last; 0: no sign of any"},
    {"air", "extinction_per_km", "red, green, blue"},
    {"air", "airlight", "linear red, green, blue of the sky just above the horizon"},
    {"optics", "point_spread_px", "standard deviation, with the codec's softness in it"},
    {"optics", "sharpening", "amount of the unsharp mask"},
    {"optics", "sharpening_px", "and its standard deviation"},
    {"sensor", "noise_gain", "variance of linear light is gain x light ..."},
    {"sensor", "noise_floor", "... + floor"},
    {"sensor", "noise_correlation_px", "white noise under a Gaussian of this width"},
    {"sensor", "chroma_spread_px", "standard deviation that chroma has beyond luma's"},
    {"sensor", "codec_step", "of the quantiser, in code values"},
    {"light", "sun_azimuth_deg", "from north, if the heading given was the camera's"},
    {"light", "sun_elevation_deg", "above the horizon"},
}};

// If not every frame gives a horizon: the reason.
std::string horizon_line(const Calibration& c) {
  if (const auto why = c.missing.find("horizon"); why != c.missing.end())
    return "# horizon: not to be had: " + why->second + "\n";
  if (const auto note = c.notes.find("horizon"); note != c.notes.end())
    return "# horizon: " + note->second + "\n";
  return "";
}

}  // namespace

std::string toml_from(const Calibration& c) {
  std::string text =
      "# Measured by airtruth calibrate. Values stand for [realism] file = \"...\" of a scene.\n";
  std::string quoted;
  for (const char ch : c.video.filename().string())
    quoted += ch == '"' || ch == '\\' || static_cast<unsigned char>(ch) < 0x20 ? '_' : ch;
  text += fmt::format("[clip]\nvideo = \"{}\"\nwidth = {}\nheight = {}\nframes = {}\n",
                      quoted,
                      c.width,
                      c.height,
                      c.frames);
  if (!c.lens.empty()) text += fmt::format("lens = \"{}\"\n", c.lens);
  if (c.tone.gamma != 0) text += fmt::format("gamma = {}\n", c.tone.gamma);
  text += horizon_line(c);
  std::string table;
  for (const Key& key : kKeys) {
    const std::string name = std::string(key.table) + "." + key.key;
    const auto value = c.values.find(name);
    const auto missing = c.missing.find(name);
    if (value == c.values.end() && missing == c.missing.end()) continue;
    if (table != key.table) text += fmt::format("\n[{}]\n", table = key.table);
    if (value == c.values.end()) {
      text += fmt::format("# {}: not to be had: {}\n", key.key, missing->second);
      continue;
    }
    if (const auto note = c.notes.find(name); note != c.notes.end())
      text += "# " + note->second + "\n";
    if (const auto doubt = c.doubts.find(name); doubt != c.doubts.end())
      text += "# doubtful: " + doubt->second + "\n";
    text += fmt::format("{} = {}  # +- {}; {}; {}\n",
                        key.key,
                        array_of(value->second, false),
                        array_of(value->second, true),
                        key.words,
                        source_words(c, name));
    if (name == "shutter.readout_s" && value->second[0].value > 0)
      text += fmt::format("readout = \"{}\"\n", c.notes.at("shutter.readout"));
  }
  return text;
}

scene::CameraModel model_of(const Calibration& c) {
  scene::CameraModel model;
  scene::for_each_camera_key(
      [&](const char* key, auto& member) {
        const auto found = c.values.find(key);
        if (found == c.values.end()) return;
        const std::vector<Estimate>& values = found->second;
        if constexpr (std::is_same_v<decltype(member), std::optional<double>&>)
          member = values[0].value;
        else
          member = {values[0].value, values[1].value, values[2].value};
      },
      model);
  if (model.readout_s) model.readout = c.notes.at("shutter.readout");
  return model;
}

}  // namespace airtruth::calibration
