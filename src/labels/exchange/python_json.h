// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>

#include <airtruth/labels.h>
#include <nlohmann/json.hpp>

#include "foundation/json/json_object.h"

namespace airtruth::exchange {

// A JSON file of at most 8 GiB as Python's json module writes it: the words that the module adds to
// JSON, NaN and Infinity in any case and with a sign, are read as null.
JsonDocument python_json(const std::filesystem::path& file);

// Adds what is known: an empty value adds no key.
template <typename T>
void put(nlohmann::ordered_json& json, const char* key, const std::optional<T>& value) {
  if (value) json[key] = *value;
}

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

}  // namespace airtruth::exchange
