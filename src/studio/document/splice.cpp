// SPDX-License-Identifier: Apache-2.0
#include "studio/document/splice.h"

#include <algorithm>
#include <vector>

#include <fmt/format.h>

#include "foundation/base/error.h"
#include "foundation/base/text.h"
#include "studio/document/tree.h"

namespace airtruth::document {
namespace {

using Json = nlohmann::ordered_json;
using Kind = Node::Kind;

// Bytes [begin, end) that give way to others.
struct Cut {
  std::size_t begin = 0;
  std::size_t end = 0;
  std::string put;
};

bool is_table_array(const Json& value) {
  return value.is_array() && !value.empty() &&
         std::ranges::all_of(value, [](const Json& one) { return one.is_object(); });
}

class Splicer {
 public:
  Splicer(std::string_view text, const Change& change, const std::string& file)
      : text_(text), change_(change), file_(file), tree_(tree_of(text, file)) {}

  std::string made() {
    switch (change_.kind) {
      case Change::Kind::kSet:
        set();
        break;
      case Change::Kind::kRemove:
        remove(existing(change_.path), change_.path);
        break;
      case Change::Kind::kInsert:
        insert();
        break;
    }
    return with_cuts();
  }

  // What the file has to say after the change, once it was made().
  nlohmann::json expected() const;

 private:
  [[noreturn]] void refuse(const std::string& what) const {
    throw Error(words_of(change_.path) + " " + what, {file_});
  }

  // The node at a path; null where a key or a place is missing.
  const Node* find(const Path& path) const {
    const Node* node = &tree_.root;
    for (const Step& step : path) {
      if (const auto* key = std::get_if<std::string>(&step)) {
        node = node->is_table() ? node->member(*key) : nullptr;
      } else {
        const auto place = std::get<std::size_t>(step);
        node = place < node->elements.size() ? &node->elements[place] : nullptr;
      }
      if (node == nullptr) return nullptr;
    }
    return node;
  }
  const Node& existing(const Path& path) const {
    const Node* node = find(path);
    if (node == nullptr) refuse("is not there; expected a key or a place that the scene has");
    return *node;
  }

  // Places in the text.

  std::string newline() const {
    const std::size_t first = text_.find('\n');
    return first != std::string_view::npos && first > 0 && text_[first - 1] == '\r' ? "\r\n" : "\n";
  }
  std::size_t line_begin(std::size_t at) const {
    const std::size_t before = at == 0 ? std::string_view::npos : text_.rfind('\n', at - 1);
    return std::max(before == std::string_view::npos ? 0 : before + 1, tree_.root.begin);
  }
  // Behind the line's end.
  std::size_t line_end(std::size_t at) const {
    const std::size_t end = text_.find('\n', at);
    return end == std::string_view::npos ? text_.size() : end + 1;
  }
  std::string_view line_at(std::size_t at) const { return text_.substr(at, line_end(at) - at); }
  static bool is_blank(std::string_view line) { return trimmed(line).empty(); }
  static bool is_comment(std::string_view line) { return trimmed(line).starts_with('#'); }
  std::string indent_at(std::size_t at) const {
    const std::string_view line = line_at(line_begin(at));
    return std::string(line.substr(0, std::min(line.find_first_not_of(" \t"), line.size())));
  }
  // A comma between two places, outside comments; npos where there is none.
  std::size_t comma(std::size_t from, std::size_t to) const {
    for (std::size_t i = from; i < to; ++i) {
      if (text_[i] == '#')
        i = line_end(i) - 1;
      else if (text_[i] == ',')
        return i;
    }
    return std::string_view::npos;
  }
  // The end of all that is written of a table under its own header.
  std::size_t own_end(const Node& node) const {
    std::size_t end = node.kind == Kind::kImpliedTable ? 0 : node.end;
    for (const Node& member : node.members)
      if (!member.has_header()) end = std::max(end, own_end(member));
    return end;
  }
  // The same with the tables in it.
  std::size_t full_end(const Node& node) const {
    std::size_t end = node.kind == Kind::kImpliedTable ? 0 : node.end;
    for (const Node& member : node.members) end = std::max(end, full_end(member));
    for (const Node& element : node.elements) end = std::max(end, full_end(element));
    return end;
  }

  // Cuts.

  void cut(std::size_t begin, std::size_t end, std::string put = "") {
    cuts_.push_back({begin, end, std::move(put)});
  }
  // Lines are put behind the line of `at`, or before all others where `at` is the file's beginning.
  void put_lines(std::size_t at, const std::string& lines) {
    if (at == tree_.root.begin) return cut(at, at, lines);
    const std::size_t end = line_end(at);
    const bool is_open = end == text_.size() && (end == 0 || text_[end - 1] != '\n');
    cut(end, end, is_open ? newline() + lines : lines);
  }
  // A block of a header, with an empty line before and behind it.
  void put_block(std::size_t at, const std::string& block) {
    const std::size_t end = at == tree_.root.begin ? at : line_end(at);
    const bool is_last = end == text_.size();
    const bool is_apart = !is_last && is_blank(line_at(end));
    put_lines(
        at,
        (at == tree_.root.begin ? "" : newline()) + block + (is_last || is_apart ? "" : newline()));
  }
  std::string with_cuts() {
    std::ranges::sort(cuts_, [](const Cut& a, const Cut& b) {
      return a.begin > b.begin || (a.begin == b.begin && a.end > b.end);
    });
    std::string result(text_);
    std::size_t before = result.size() + 1;
    for (const Cut& one : cuts_) {
      if (one.end > before) refuse("cannot be changed in place; edit the file");
      before = one.begin;
      result.replace(one.begin, one.end - one.begin, one.put);
    }
    return result;
  }

  // Text of new tables.

  // A header's names from the top, without the places.
  static std::string header_names(const Path& path) {
    std::string names;
    for (const Step& step : path)
      if (const auto* key = std::get_if<std::string>(&step))
        names += (names.empty() ? "" : ".") + toml_key(*key);
    return names;
  }
  // The lines of a table: first its values, then its tables.
  std::string block_of(const std::string& names,
                       const Json& table,
                       bool is_element,
                       const std::string& indent) const {
    std::string text = indent + (is_element ? "[[" + names + "]]" : "[" + names + "]") + newline();
    for (const auto& [key, value] : table.items())
      if (!value.is_object() && !is_table_array(value))
        text += indent + toml_key(key) + " = " + toml_of(value) + newline();
    for (const auto& [key, value] : table.items()) {
      const std::string inner = names + "." + toml_key(key);
      if (value.is_object()) text += newline() + block_of(inner, value, false, indent);
      if (is_table_array(value))
        for (const Json& element : value)
          text += newline() + block_of(inner, element, true, indent);
    }
    return text;
  }

  // {"set": ...}

  void set() {
    if (const Node* node = find(change_.path)) return replace(*node, change_.value);
    // The longest part of the path that is there, and the value in the tables that are not.
    Path parent = change_.path;
    Json value = change_.value;
    for (;;) {
      const Step last = parent.back();
      parent.pop_back();
      if (!std::holds_alternative<std::string>(last))
        refuse("is not there; expected a place that the array has");
      const auto& key = std::get<std::string>(last);
      if (const Node* node = find(parent)) return add(*node, parent, key, value);
      value = Json::object({{key, std::move(value)}});
    }
  }

  // Part by part where the parts correspond, so that what stands between them stays.
  void replace(const Node& node, const Json& value) {
    if (node.kind == Kind::kInlineArray && value.is_array() &&
        value.size() == node.elements.size()) {
      for (std::size_t i = 0; i < value.size(); ++i) replace(node.elements[i], value[i]);
      return;
    }
    if (node.kind == Kind::kTableArray || node.kind == Kind::kHeaderTable ||
        node.kind == Kind::kImpliedTable)
      refuse("is a table of its own; expected a change of one of its keys");
    const std::string put = toml_of(value);
    if (text_.substr(node.begin, node.end - node.begin) != put) cut(node.begin, node.end, put);
  }

  void add(const Node& table, const Path& path, const std::string& key, const Json& value) {
    if (!table.is_table()) refuse("lies in a value; expected a table there");
    if (table.kind == Kind::kInlineTable) return add_inline(table, toml_key(key), value);
    Path names = path;
    names.emplace_back(key);
    if (value.is_object())
      return put_block(end_for_block(table), block_of(header_names(names), value, false, ""));
    if (is_table_array(value)) {
      std::string blocks;
      for (const Json& element : value)
        blocks +=
            (blocks.empty() ? "" : newline()) + block_of(header_names(names), element, true, "");
      return put_block(end_for_block(table), blocks);
    }
    add_line(table, path, toml_key(key) + " = " + toml_of(value));
  }
  std::size_t end_for_block(const Node& table) const {
    return &table == &tree_.root ? std::max(text_.size(), std::size_t{1}) - 1 : full_end(table);
  }

  void add_line(const Node& table, const Path& path, const std::string& line) {
    const std::size_t end = own_end(table);
    if (table.kind == Kind::kImpliedTable && end == 0)
      return put_block(text_.empty() ? 0 : text_.size() - 1,
                       "[" + header_names(path) + "]" + newline() + line + newline());
    if (table.kind == Kind::kImpliedTable) {
      // As its other keys are dotted.
      const Node& last = table.members.back();
      const std::size_t begin = line_begin(last.key_begin);
      return put_lines(end,
                       std::string(text_.substr(begin, last.key_begin - begin)) + line + newline());
    }
    const bool is_first = &table == &tree_.root && end == table.begin;
    put_lines(end,
              (is_first ? "" : indent_at(end == table.end ? table.begin : last_key(table))) + line +
                  newline() + (is_first && !is_blank(line_at(end)) ? newline() : ""));
  }
  std::size_t last_key(const Node& table) const {
    std::size_t at = table.begin;
    for (const Node& member : table.members)
      if (!member.has_header()) at = std::max(at, member.key_begin);
    return at;
  }

  void add_inline(const Node& table, const std::string& key, const Json& value) {
    const std::string put = key + " = " + toml_of(value);
    if (table.members.empty()) return cut(table.begin, table.end, "{ " + put + " }");
    std::size_t end = 0;
    for (const Node& member : table.members) end = std::max(end, full_end(member));
    cut(end, end, ", " + put);
  }

  // {"remove": ...}

  void remove(const Node& node, const Path& path) {
    if (path.size() == 0) refuse("is the whole file");
    if (node.kind == Kind::kImpliedTable) {
      for (const Node& member : node.members) {
        Path inner = path;
        inner.emplace_back(member.key);
        remove(member, inner);
      }
      return;
    }
    if (node.kind == Kind::kTableArray) {
      for (const Node& element : node.elements) remove_blocks(element);
      return;
    }
    if (node.kind == Kind::kHeaderTable) return remove_blocks(node);
    Path parent_path = path;
    parent_path.pop_back();
    const Node& parent = existing(parent_path);
    if (parent.kind == Kind::kInlineArray || is_inside_inline(parent_path))
      return remove_part(parent, node);
    cut(line_begin(node.key_begin), line_end(node.end));
  }
  bool is_inside_inline(Path path) const {
    for (; !path.empty(); path.pop_back()) {
      const Kind kind = existing(path).kind;
      if (kind == Kind::kInlineTable || kind == Kind::kInlineArray) return true;
    }
    return false;
  }

  // One of several parts between commas.
  void remove_part(const Node& parent, const Node& node) {
    const std::size_t begin = parent.kind == Kind::kInlineArray ? node.begin : node.key_begin;
    const auto is_next = [&](std::size_t at) { return at > node.begin; };
    std::size_t next = parent.end - 1;
    std::size_t before = parent.begin + 1;
    const auto look = [&](std::size_t its_begin, std::size_t its_end) {
      if (is_next(its_begin))
        next = std::min(next, its_begin);
      else if (its_end <= begin)
        before = std::max(before, its_end);
    };
    for (const Node& one : parent.elements) look(one.begin, one.end);
    for (const Node& one : parent.members) look(one.key_begin, full_end(one));
    if (const std::size_t at = comma(node.end, next); at != std::string_view::npos) {
      const std::size_t end = text_.find_first_not_of(" \t", at + 1);
      return cut(begin, end == std::string_view::npos ? text_.size() : end);
    }
    if (const std::size_t at = comma(before, begin); at != std::string_view::npos) {
      if (is_blank(text_.substr(at + 1, begin - at - 1))) return cut(at, node.end);
      cut(at, at + 1);
    }
    cut(begin, node.end);
  }

  // The lines of a header and of the headers below it. Comments behind its last key stay.
  void remove_blocks(const Node& node) {
    std::vector<Cut> blocks;
    collect_blocks(node, blocks);
    std::ranges::sort(blocks, {}, &Cut::begin);
    for (std::size_t i = 0; i < blocks.size(); ++i) {
      Cut whole = blocks[i];
      while (i + 1 < blocks.size() &&
             is_blank(text_.substr(whole.end, blocks[i + 1].begin - whole.end)))
        whole.end = blocks[++i].end;
      // Of the empty lines on both sides one side goes.
      if (whole.begin == tree_.root.begin || is_blank(line_at(line_begin(whole.begin - 1))))
        while (whole.end < text_.size() && is_blank(line_at(whole.end)))
          whole.end = line_end(whole.end);
      cuts_.push_back(whole);
    }
  }
  void collect_blocks(const Node& node, std::vector<Cut>& blocks) const {
    if (node.kind == Kind::kHeaderTable)
      blocks.push_back({line_begin(node.begin), line_end(own_end(node)), ""});
    for (const Node& member : node.members)
      if (member.has_header() || member.kind == Kind::kImpliedTable) collect_blocks(member, blocks);
    for (const Node& element : node.elements) collect_blocks(element, blocks);
  }

  // {"insert": ...}

  void insert() {
    const Node* array = find(change_.path);
    if (array == nullptr) return insert_first();
    const std::size_t count = array->elements.size();
    const std::size_t at = change_.at.value_or(count);
    if (at > count)
      refuse(fmt::format("has {} elements; expected a place from 0 to {}", count, count));
    if (array->kind == Kind::kInlineArray) return insert_inline(*array, at);
    if (array->kind != Kind::kTableArray) refuse("is no array of tables");
    const std::string block = block_of(
        header_names(change_.path), change_.value, true, indent_at(array->elements.front().begin));
    if (at == count) return put_block(full_end(array->elements.back()), block);
    std::size_t begin = line_begin(array->elements[at].begin);
    while (begin > tree_.root.begin && is_comment(line_at(line_begin(begin - 1))))
      begin = line_begin(begin - 1);
    cut(begin, begin, block + newline());
  }
  void insert_first() {
    if (change_.at.value_or(0) != 0) refuse("is not there; expected the place 0");
    Path parent = change_.path;
    const Step last = parent.back();
    parent.pop_back();
    if (!std::holds_alternative<std::string>(last)) refuse("is no array of tables");
    add(existing(parent), parent, std::get<std::string>(last), Json::array({change_.value}));
  }
  void insert_inline(const Node& array, std::size_t at) {
    const std::string put = toml_of(change_.value);
    if (array.elements.empty()) return cut(array.begin, array.end, "[" + put + "]");
    if (at < array.elements.size()) {
      const std::size_t begin = array.elements[at].begin;
      return cut(begin, begin, put + ", ");
    }
    const std::size_t end = full_end(array.elements.back());
    cut(end, end, ", " + put);
  }

  std::string_view text_;
  const Change& change_;
  const std::string& file_;
  Tree tree_;
  std::vector<Cut> cuts_;
};

// As a TOML reader sees the value that is written.
nlohmann::json read_back(const Json& value) {
  return tree_of("v = " + toml_of(value), "").values["v"];
}

nlohmann::json* descend(nlohmann::json& from, const Step& step) {
  if (const auto* key = std::get_if<std::string>(&step))
    return from.is_object() && from.contains(*key) ? &from[*key] : nullptr;
  const auto place = std::get<std::size_t>(step);
  return from.is_array() && place < from.size() ? &from[place] : nullptr;
}

nlohmann::json Splicer::expected() const {
  nlohmann::json values = tree_.values;
  nlohmann::json* parent = &values;
  nlohmann::json* node = &values;
  for (const Step& step : change_.path) {
    parent = node;
    const auto* key = std::get_if<std::string>(&step);
    // A key that is not there is made.
    node = key != nullptr ? &(*node)[*key] : &node->at(std::get<std::size_t>(step));
  }
  if (change_.kind == Change::Kind::kRemove) {
    const Step& last = change_.path.back();
    if (const auto* key = std::get_if<std::string>(&last))
      parent->erase(*key);
    else
      parent->erase(std::get<std::size_t>(last));
  } else if (change_.kind == Change::Kind::kSet) {
    *node = read_back(change_.value);
  } else {
    if (node->is_null()) *node = nlohmann::json::array();
    const auto at = static_cast<std::ptrdiff_t>(change_.at.value_or(node->size()));
    node->insert(node->begin() + at, read_back(change_.value));
  }
  return values;
}

// Without empty arrays and tables: what loses its last header is gone with it.
void prune(nlohmann::json& values) {
  for (auto it = values.begin(); it != values.end();) {
    if (it->is_structured()) prune(*it);
    it =
        values.is_object() && it->is_structured() && it->empty() ? values.erase(it) : std::next(it);
  }
}

bool says(const std::string& text, nlohmann::json expected, const std::string& file) {
  nlohmann::json got;
  try {
    got = tree_of(text, file).values;
  } catch (const Error&) {
    return false;
  }
  prune(got);
  prune(expected);
  return got == expected;
}

// A table whose keys are set one by one keeps what stands between them.
std::string with_keys(std::string_view text,
                      const Change& change,
                      const nlohmann::json& before,
                      const std::string& file) {
  std::string result(text);
  for (const auto& [key, value] : before.items()) {
    if (change.value.contains(key)) continue;
    Change removal{Change::Kind::kRemove, change.path, {}, {}};
    removal.path.emplace_back(key);
    result = changed(result, removal, file);
  }
  for (const auto& [key, value] : change.value.items()) {
    Change setting{Change::Kind::kSet, change.path, {}, value};
    setting.path.emplace_back(key);
    result = changed(result, setting, file);
  }
  return result;
}

}  // namespace

std::string changed(std::string_view text, const Change& change, const std::string& file) {
  if (change.kind == Change::Kind::kSet && change.value.is_object()) {
    nlohmann::json values = tree_of(text, file).values;
    nlohmann::json* node = &values;
    for (const Step& step : change.path) node = node ? descend(*node, step) : nullptr;
    if (node != nullptr && node->is_object()) return with_keys(text, change, *node, file);
  }
  Splicer splicer(text, change, file);
  std::string result = splicer.made();
  if (!says(result, splicer.expected(), file))
    throw Error(words_of(change.path) + " cannot be changed in place; edit the file", {file});
  return result;
}

}  // namespace airtruth::document
