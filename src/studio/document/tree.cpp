// SPDX-License-Identifier: Apache-2.0
#include "studio/document/tree.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <toml++/toml.h>

#include "foundation/base/text.h"
#include "scene/scene/tables.h"

namespace airtruth::document {
namespace {

// Finds the byte of a line and column. toml++ counts columns in code points.
class Lines {
 public:
  explicit Lines(std::string_view text) : text_(text) {
    starts_.push_back(text.size() == without_mark(text).size() ? 0 : 1);
    for (std::size_t i = 0; i < text.size(); ++i) {
      if ((static_cast<unsigned char>(text[i]) & 0xC0U) != 0x80U) points_.push_back(i);
      if (text[i] == '\n') starts_.push_back(points_.size());
    }
  }

  std::size_t offset(const toml::source_position& place) const {
    if (place.line == 0 || place.line > starts_.size()) return text_.size();
    const std::size_t point = starts_[place.line - 1] + place.column - 1;
    return point < points_.size() ? points_[point] : text_.size();
  }

 private:
  std::string_view text_;
  std::vector<std::size_t> points_;  // the byte of each code point
  std::vector<std::size_t> starts_;  // the first code point of each line
};

class Reader {
 public:
  explicit Reader(std::string_view text) : text_(text), lines_(text) {}

  Node table(const toml::table& table, Node::Kind kind) const {
    Node node = placed(table, kind);
    for (const auto& [key, value] : table) {
      node.members.push_back(read(value, &key));
      node.members.back().key = key.str();
      node.members.back().key_begin = lines_.offset(key.source().begin);
    }
    std::ranges::sort(node.members, {}, &Node::key_begin);
    return node;
  }

 private:
  Node placed(const toml::node& value, Node::Kind kind) const {
    Node node;
    node.kind = kind;
    node.begin = lines_.offset(value.source().begin);
    node.end = lines_.offset(value.source().end);
    node.line = static_cast<int>(value.source().begin.line);
    node.column = static_cast<int>(value.source().begin.column);
    return node;
  }

  // A table of a header begins with the bracket of a header whose last name is its own.
  bool is_header(const toml::key& key, const toml::table& value) const {
    const std::size_t begin = lines_.offset(value.source().begin);
    if (begin >= text_.size() || text_[begin] != '[') return false;
    const std::size_t next = text_.find_first_not_of(" \t", lines_.offset(key.source().end));
    return next != std::string_view::npos && text_[next] == ']';
  }

  // `key`: of a member of a table; nullptr of an element of an array.
  Node read(const toml::node& value, const toml::key* key) const {
    if (const auto* inside = value.as_table()) {
      if (inside->is_inline()) return table(*inside, Node::Kind::kInlineTable);
      const bool is_implied = key != nullptr && !is_header(*key, *inside);
      return table(*inside, is_implied ? Node::Kind::kImpliedTable : Node::Kind::kHeaderTable);
    }
    const auto* array = value.as_array();
    if (array == nullptr) return placed(value, Node::Kind::kValue);
    const auto* first = array->empty() ? nullptr : array->front().as_table();
    const bool is_of_headers = first != nullptr && !first->is_inline();
    Node node = placed(value, is_of_headers ? Node::Kind::kTableArray : Node::Kind::kInlineArray);
    for (const toml::node& part : *array) node.elements.push_back(read(part, nullptr));
    return node;
  }

  std::string_view text_;
  Lines lines_;
};

nlohmann::json json_of(const toml::node& value) {
  if (const auto* table = value.as_table()) {
    nlohmann::json json = nlohmann::json::object();
    for (const auto& [key, part] : *table) json[std::string(key.str())] = json_of(part);
    return json;
  }
  if (const auto* array = value.as_array()) {
    nlohmann::json json = nlohmann::json::array();
    for (const toml::node& part : *array) json.push_back(json_of(part));
    return json;
  }
  if (const auto* text = value.as_string()) return text->get();
  if (const auto* whole = value.as_integer()) return whole->get();
  if (const auto* truth = value.as_boolean()) return truth->get();
  if (const auto* number = value.as_floating_point(); number && std::isfinite(number->get()))
    return number->get();
  std::ostringstream words;
  value.visit([&](const auto& any) { words << any; });
  return words.str();
}

// A comment's words, without what opens it.
std::string_view words_of_comment(std::string_view line) {
  const std::size_t words = line.find_first_not_of("# \t");
  return words == std::string_view::npos ? std::string_view{} : trimmed(line.substr(words));
}

std::string note_on(std::string_view text, std::size_t begin, std::size_t end) {
  const auto line_at = [&](std::size_t at) {
    return trimmed(text.substr(at, std::min(text.find('\n', at), text.size()) - at));
  };
  std::vector<std::string_view> parts;
  std::size_t line = text.rfind('\n', begin);
  while (line != std::string_view::npos && line > 0) {
    const std::size_t above = text.rfind('\n', line - 1);
    const std::string_view words = line_at(above == std::string_view::npos ? 0 : above + 1);
    if (!words.starts_with('#')) break;
    parts.insert(parts.begin(), words_of_comment(words));
    line = above;
  }
  const std::string_view rest = line_at(end);
  if (rest.starts_with('#')) parts.push_back(words_of_comment(rest));
  return fmt::format("{}", fmt::join(parts, " "));
}

void add_notes(const Node& table,
               const std::string& prefix,
               std::string_view text,
               nlohmann::ordered_json& notes) {
  for (const Node& member : table.members) {
    const std::string name = prefix + member.key;
    const bool is_header = member.kind == Node::Kind::kHeaderTable;
    const bool is_implied = member.kind == Node::Kind::kImpliedTable;
    if (!is_implied && member.kind != Node::Kind::kTableArray) {
      const std::size_t begin = is_header ? member.begin : member.key_begin;
      if (std::string note = note_on(text, begin, member.end); !note.empty())
        notes[name] = std::move(note);
    }
    if (is_header || is_implied) add_notes(member, name + ".", text, notes);
  }
}

}  // namespace

nlohmann::ordered_json notes_of(const Node& root, std::string_view text) {
  nlohmann::ordered_json notes = nlohmann::ordered_json::object();
  add_notes(root, "", text, notes);
  return notes;
}

const Node* Node::member(std::string_view name) const {
  const auto found = std::ranges::find(members, name, &Node::key);
  return found == members.end() ? nullptr : &*found;
}

Tree tree_of(std::string_view text, const std::string& file) {
  const toml::table parsed = scene::parsed_toml(text, file);
  Tree tree{Reader(text).table(parsed, Node::Kind::kHeaderTable), json_of(parsed)};
  tree.root.begin = tree.root.end = text.size() - without_mark(text).size();
  return tree;
}

}  // namespace airtruth::document
