// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

// A TOML text as values and as the places where they stand.
namespace airtruth::document {

// Offsets are bytes of the text.
struct Node {
  enum class Kind {
    kValue,
    kInlineTable,   // { ... }
    kInlineArray,   // [ ... ]
    kHeaderTable,   // [name], or an element of [[name]]; the file itself, with an empty header
    kImpliedTable,  // of dotted keys, or between the names of a header
    kTableArray,    // of [[name]]
  };
  Kind kind = Kind::kValue;
  // Of the value, or of the header with its brackets.
  std::size_t begin = 0;
  std::size_t end = 0;
  // Of its beginning, as messages name it.
  int line = 0;
  int column = 0;
  // Of a member of a table: the last name of its key, and where that begins: in `a.b = 1` the `b`.
  std::string key;
  std::size_t key_begin = 0;
  std::vector<Node> members;   // of a table, in the order of the text
  std::vector<Node> elements;  // of an array

  bool is_table() const {
    return kind == Kind::kInlineTable || kind == Kind::kHeaderTable || kind == Kind::kImpliedTable;
  }
  bool has_header() const { return kind == Kind::kHeaderTable || kind == Kind::kTableArray; }
  const Node* member(std::string_view name) const;
};

struct Tree {
  Node root;
  nlohmann::json values;  // dates and times, infinities and NaN as strings
};

// The comments on the tables of the file and on their keys, by the dotted name: the lines directly
// above a table's header or a key, and the end of its own line.
//
//   # measured in May
//   [camera]
//   position_ned_m = [0, 0, -150]  # a guess
//
// gives {"camera": "measured in May", "camera.position_ned_m": "a guess"}.
nlohmann::ordered_json notes_of(const Node& root, std::string_view text);

// Throws Error where the text is not TOML (scene::parsed_toml).
Tree tree_of(std::string_view text, const std::string& file);

}  // namespace airtruth::document
