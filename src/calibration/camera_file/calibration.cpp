// SPDX-License-Identifier: Apache-2.0
#include "calibration/camera_file/calibration.h"

#include <algorithm>
#include <stdexcept>
#include <type_traits>

#include <fmt/format.h>

#include "foundation/base/text.h"
#include "scene/scene/camera_keys.h"

namespace airtruth::camera_file {
namespace {

const QuantityKey& key_of(std::string_view name) {
  const auto found = std::ranges::find(kQuantityKeys, name, &QuantityKey::name);
  if (found == kQuantityKeys.end())
    throw std::out_of_range("no quantity has the key " + std::string(name));
  return *found;
}

// A number as text, with four significant digits.
std::string shown(double value) { return fmt::format("{:.4g}", value); }

std::string source_words(const Calibration& c, const Quantity& quantity) {
  if (!quantity.source.empty()) return quantity.source;
  return c.clips > 1 ? "the clips' own" : "the clip's own";
}

std::string array_of(const std::vector<Estimate>& values, bool errors) {
  std::string text;
  for (const Estimate& e : values)
    text += (text.empty() ? "" : ", ") + shown(errors ? e.sigma : e.value);
  return values.size() == 1 ? text : "[" + text + "]";
}

std::string horizon_line(const Calibration& c) {
  if (!c.no_horizon.empty()) return "# horizon: not measured: " + c.no_horizon + "\n";
  if (!c.horizon_note.empty()) return "# horizon: " + c.horizon_note + "\n";
  return "";
}

// The table [clip] with the comments above it.
std::string head_of(const Calibration& c) {
  std::string text =
      "# Measured by airtruth calibrate. Values stand for [realism] file = \"...\" of a scene.\n";
  text += fmt::format("[clip]\nvideo = {}\nwidth = {}\nheight = {}\nframes = {}\n",
                      toml_string(c.video.filename().string()),
                      c.width,
                      c.height,
                      c.frames);
  if (!c.lens.empty()) text += fmt::format("lens = {}\n", toml_string(c.lens));
  if (c.tone.gamma != 0) text += fmt::format("gamma = {}\n", c.tone.gamma);
  return text + horizon_line(c);
}

std::string lines_of(const Calibration& c, const QuantityKey& key) {
  const Quantity& quantity = c.quantities.*key.member;
  if (!quantity.is_measured())
    return fmt::format("# {}: not measured: {}\n", key.key(), quantity.missing);
  std::string text;
  if (!quantity.note.empty()) text += "# " + quantity.note + "\n";
  if (!quantity.doubt.empty()) text += "# doubtful: " + quantity.doubt + "\n";
  text += fmt::format("{} = {}  # +- {}; {}; {}\n",
                      key.key(),
                      array_of(quantity.values, false),
                      array_of(quantity.values, true),
                      key.words,
                      source_words(c, quantity));
  if (key.member == &Quantities::readout && quantity.value().value > 0)
    text += fmt::format("readout = \"{}\"\n", c.readout_direction);
  return text;
}

}  // namespace

void put(Quantity& quantity, const Measured<Estimate>& measured) {
  if (measured)
    quantity.values = {*measured};
  else
    quantity.missing = measured.why();
}

void put(Quantity& quantity, const Measured<ColourEstimate>& measured) {
  if (measured)
    quantity.values.assign(measured->begin(), measured->end());
  else
    quantity.missing = measured.why();
}

Quantity& Quantities::at(std::string_view key) { return this->*key_of(key).member; }

const Quantity& Quantities::at(std::string_view key) const { return this->*key_of(key).member; }

std::string_view QuantityKey::table() const {
  const std::string_view whole(name);
  return whole.substr(0, whole.find('.'));
}

std::string_view QuantityKey::key() const {
  const std::string_view whole(name);
  return whole.substr(whole.find('.') + 1);
}

std::string toml_from(const Calibration& c) {
  std::string text = head_of(c);
  std::string_view table;
  for (const QuantityKey& key : kQuantityKeys) {
    const Quantity& quantity = c.quantities.*key.member;
    if (!quantity.is_measured() && quantity.missing.empty()) continue;
    if (table != key.table()) text += fmt::format("\n[{}]\n", table = key.table());
    text += lines_of(c, key);
  }
  return text;
}

scene::CameraModel model_of(const Calibration& c) {
  scene::CameraModel model;
  scene::for_each_camera_key(
      [&](const char* key, auto& member) {
        const std::vector<Estimate>& values = c.quantities.at(key).values;
        if (values.empty()) return;
        if constexpr (std::is_same_v<decltype(member), std::optional<double>&>)
          member = values[0].value;
        else
          member = {values[0].value, values[1].value, values[2].value};
      },
      model);
  if (model.readout_s) model.readout = enum_named<Readout>(c.readout_direction);
  return model;
}

std::string lens_words(const lens::Lens& lens) {
  return fmt::format("{} {:.1f} px", lens.name(), lens.focal_px());
}

}  // namespace airtruth::camera_file
