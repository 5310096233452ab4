// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <airtruth/labels.h>
#include <nlohmann/json.hpp>

#include "foundation/json/json_object.h"

// The file labels.jsonl (docs/formats/labels.md), which <airtruth/labels.h> reads and writes, and
// its label as other formats of JSON hold it.
namespace airtruth::label_file {

using exchange::Label;

// The class of a region in which detections count neither way.
inline constexpr const char* kIgnore = "ignore";

// The longest side of a picture, in pixels, and the highest frame rate of a clip, in frames/s:
// beyond every camera. The file holds neither more.
constexpr std::int64_t kLongestSide_px = 1'000'000;
constexpr double kHighestRate_hz = 1e6;

// The frame rate of a clip; empty (unknown) where the value is missing, not above 0 or above
// kHighestRate_hz.
std::optional<double> rate_of(const std::optional<double>& value);

// Calls visit(key, member) for the fields of a label that may be unknown, except its area and mask.
// `visible_key` is the key of the visible share.
template <typename AnyLabel, typename Visit>
void each_known(AnyLabel& label, const char* visible_key, const Visit& visit) {
  visit(visible_key, label.visible);
  visit("occluded", label.occluded);
  visit("truncated", label.truncated);
  visit("range_m", label.range_m);
  visit("above_horizon", label.above_horizon);
  visit("contrast_to_noise", label.contrast_to_noise);
}
void get_known(const JsonObject& json, Label& label, const char* visible_key);

// A label as labels.jsonl states it (docs/formats/labels.md), without its mask.
nlohmann::ordered_json json_of_label(const Label& label);
// Throws Error where it is not as described there.
Label label_of_json(const JsonObject& json);

// What is wrong with the tracks of a frame, as the end of a message; empty where no two labels have
// one track. Regions in which detections count neither way may share one.
std::optional<std::string> repeated_track_in(const exchange::LabelledFrame& frame);

}  // namespace airtruth::label_file
