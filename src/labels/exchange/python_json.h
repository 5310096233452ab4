// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>

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

}  // namespace airtruth::exchange
