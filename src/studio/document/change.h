// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include <nlohmann/json.hpp>

#include "foundation/json/json_object.h"

// A change of a scene file, as the page asks for it.
namespace airtruth::document {

// From the top of the file: keys of tables and places in arrays.
using Step = std::variant<std::string, std::size_t>;
using Path = std::vector<Step>;

// Examples, as JSON:
//   {"set": ["intruder", 0, "seen", 1, "pixel"], "to": [613.2, 288]}
//   {"remove": ["intruder", 0, "seen", 1]}
//   {"insert": ["intruder"], "at": 2, "table": {"id": "b", "aircraft": "738/738-Ryanair"}}
struct Change {
  enum class Kind { kSet, kRemove, kInsert };
  Kind kind = Kind::kSet;
  Path path;
  // Of an insertion into an array of tables: its place there; empty: behind the last one.
  std::optional<std::size_t> at;
  // Of kSet the value, of kInsert the table; the order of its keys is that of the text.
  nlohmann::ordered_json value;
};

// Throws Error for what is no change.
Change change_from(const nlohmann::ordered_json& json, const std::string& place);

// "intruder[0].seen[1].pixel"
std::string words_of(const Path& path);

// A value as it is written in a scene file, inline: numbers with at most 6 decimals and none
// superfluous, strings in quotation marks, arrays and tables in one line. Throws Error for a null.
std::string toml_of(const nlohmann::ordered_json& value);
// A key of a table, in quotation marks where it needs them.
std::string toml_key(const std::string& key);

}  // namespace airtruth::document
