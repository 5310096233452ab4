// SPDX-License-Identifier: Apache-2.0
#include "scene/scene/table_reader.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/base/names.h"
#include "foundation/base/text.h"

namespace airtruth::scene {
namespace {

const toml::table kAbsent;

const char* words_of(toml::node_type type) {
  using enum toml::node_type;
  return type == string           ? "a string"
         : type == integer        ? "an integer"
         : type == floating_point ? "a number with a fraction"
         : type == boolean        ? "a boolean"
         : type == array          ? "an array"
         : type == table          ? "a table"
                                  : "a date or time";
}

[[noreturn]] void fail_at(const Where& where,
                          std::string_view name,
                          std::string_view found,
                          std::string_view expected) {
  throw Error(fmt::format("{} is {}; expected {}", name, found, expected), where);
}

// Joins words as "a, b or c".
std::string listed(const std::vector<std::string>& words) {
  std::string result;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (i > 0) result += i + 1 == words.size() ? " or " : ", ";
    result += words[i];
  }
  return result;
}

bool has_control_character(std::string_view text) { return std::ranges::any_of(text, is_control); }

std::string element_name(std::string_view key, std::size_t i) {
  return fmt::format("{}[{}]", key, i);
}

thread_local std::function<void(const std::string&, const KeyUse&)> t_on_key_use;

}  // namespace

void call_on_key_use(std::function<void(const std::string& path, const KeyUse& use)> call) {
  t_on_key_use = std::move(call);
}

TableReader::Keys keys(std::string_view words) { return words_in<std::string_view>(words); }

std::string in_quotes(std::string_view text) {
  std::string result = "'";
  for (const char c : text.substr(0, 60)) result += is_control(c) ? '?' : c;
  while (text.size() > 60 && (static_cast<unsigned char>(result.back()) & 0xc0) == 0x80)
    result.pop_back();
  if (text.size() > 60) {
    if (static_cast<unsigned char>(result.back()) >= 0xc0) result.pop_back();
    result += "...";
  }
  return result + "'";
}

TableReader::TableReader(const toml::table& table,
                         std::string title,
                         const std::string& file,
                         const Keys& keys,
                         std::string path)
    : table_(&table),
      title_(std::move(title)),
      path_(std::move(path)),
      file_(file),
      where_(place(table)),
      keys_(keys.begin(), keys.end()) {
  for (const std::string& key : keys_) note(key, KnownKey{});
  refuse_unknown();
}

void TableReader::refuse_unknown() const {
  const toml::key* first = nullptr;
  for (const auto& [key, value] : *table_) {
    if (std::ranges::find(keys_, key.str()) != keys_.end()) continue;
    if (!first || key.source().begin < first->source().begin) first = &key;
  }
  if (!first) return;
  const std::string advice =
      did_you_mean(first->str().substr(0, 60), keys_, "; expected " + listed(keys_));
  const auto begin = first->source().begin;
  throw Error(fmt::format("unknown key {} in {}{}", in_quotes(first->str()), title_, advice),
              {file_, static_cast<int>(begin.line), static_cast<int>(begin.column)});
}

const toml::node* TableReader::node(std::string_view key) const {
  check(std::ranges::find(keys_, key) != keys_.end(), "a key that is read is a key that is known");
  note(key, ReadKey{});
  return table_->get(key);
}

std::string TableReader::path_of(std::string_view key) const {
  return path_.empty() ? std::string(key) : fmt::format("{}.{}", path_, key);
}

void TableReader::note(std::string_view key, const KeyUse& use) const {
  if (t_on_key_use) t_on_key_use(path_of(key), use);
}

Where TableReader::place(const toml::node& node) const {
  const auto begin = node.source().begin;
  return {file_, static_cast<int>(begin.line), static_cast<int>(begin.column)};
}

bool TableReader::has(std::string_view key) const { return node(key) != nullptr; }
bool TableReader::says(std::string_view key, std::string_view word) const {
  return toml::node_view(node(key)).value<std::string_view>() == word;
}
bool TableReader::is_array(std::string_view key) const {
  return toml::node_view(node(key)).is_array();
}
bool TableReader::is_table(std::string_view key) const {
  return toml::node_view(node(key)).is_table();
}

Where TableReader::where() const { return where_; }

Where TableReader::where(std::string_view key) const {
  const toml::node* const value = node(key);
  return value ? place(*value) : where();
}

Where TableReader::where(std::string_view key, std::size_t i) const {
  const toml::array* const array = toml::node_view(node(key)).as_array();
  return array && i < array->size() ? place((*array)[i]) : where(key);
}

void TableReader::fail(std::string_view key, std::string_view message) const {
  throw Error(message, where(key));
}

double TableReader::checked_number(const toml::node& node,
                                   const std::string& name,
                                   const Limits& limits) const {
  if (!node.is_number()) fail_at(place(node), name, words_of(node.type()), limits.expected);
  // toml++ returns no double for an integer that a double cannot represent exactly.
  const double value =
      node.is_integer() ? static_cast<double>(**node.as_integer()) : **node.as_floating_point();
  if (!limits.holds(value)) fail_at(place(node), name, fmt::format("{}", value), limits.expected);
  // Adding 0 turns -0 into 0.
  return value + 0.0;
}

std::optional<double> TableReader::number(std::string_view key, const Limits& limits) const {
  const toml::node* const value = node(key);
  note(key, NumberKey{NumberShape::kOne, {limits}});
  if (!value) return std::nullopt;
  return checked_number(*value, std::string(key), limits);
}

std::optional<std::int64_t> TableReader::whole(std::string_view key,
                                               std::int64_t low,
                                               std::int64_t high) const {
  const toml::node* const value = node(key);
  note(key, WholeKey{low, high});
  if (!value) return std::nullopt;
  const std::string expected = high == std::numeric_limits<std::int64_t>::max()
                                   ? fmt::format("a whole number not below {}", low)
                                   : fmt::format("a whole number from {} to {}", low, high);
  if (!value->is_integer()) fail_at(place(*value), key, words_of(value->type()), expected);
  const std::int64_t number = **value->as_integer();
  if (number < low || number > high)
    fail_at(place(*value), key, fmt::format("{}", number), expected);
  return number;
}

std::optional<bool> TableReader::truth(std::string_view key) const {
  const toml::node* const value = node(key);
  if (!value) return std::nullopt;
  if (!value->is_boolean()) fail_at(place(*value), key, words_of(value->type()), "true or false");
  return **value->as_boolean();
}

std::optional<std::string> TableReader::text(std::string_view key) const {
  const toml::node* const value = node(key);
  if (!value) return std::nullopt;
  if (!value->is_string()) fail_at(place(*value), key, words_of(value->type()), "a string");
  const std::string& text = **value->as_string();
  if (text.empty()) fail_at(place(*value), key, "empty", "a text");
  if (has_control_character(text))
    fail_at(place(*value), key, in_quotes(text), "a text without control characters");
  return text;
}

std::optional<std::vector<std::string>> TableReader::texts(std::string_view key) const {
  const toml::node* const value = node(key);
  if (!value) return std::nullopt;
  const toml::array& elements = array(key, "an array of strings");
  if (elements.empty()) fail_at(place(*value), key, "an empty array", "at least one string");
  std::vector<std::string> result;
  for (const toml::node& element : elements) {
    if (!element.is_string())
      fail_at(place(element), key, words_of(element.type()), "an array of strings");
    const std::string& text = **element.as_string();
    if (text.empty() || has_control_character(text))
      fail_at(place(element),
              key,
              text.empty() ? "an empty string" : in_quotes(text),
              "strings that are not empty and hold no control characters");
    result.push_back(text);
  }
  return result;
}

std::optional<std::string> TableReader::file_name(std::string_view key) const {
  const auto name = text(key);
  if (name && !is_plain_file_name(*name))
    fail_at(where(key), key, in_quotes(*name), kPlainFileName);
  return name;
}

std::optional<std::string> TableReader::choice(std::string_view key,
                                               const std::vector<std::string>& choices) const {
  const auto word = text(key);
  if (!word || std::ranges::find(choices, *word) != choices.end()) return word;
  fail_at(where(key),
          key,
          in_quotes(*word),
          listed(choices) + did_you_mean(word->substr(0, 60), choices));
}

std::optional<std::filesystem::path> TableReader::path(std::string_view key) const {
  const auto name = text(key);
  if (!name) return std::nullopt;
  auto path = normal_path(std::filesystem::path(file_).parent_path() / *name);
  // The record of a sequence contains the full path.
  require_utf8(std::filesystem::absolute(path));
  return path;
}

const toml::array& TableReader::array(std::string_view key, std::string_view expected) const {
  const toml::node* const value = node(key);
  if (!value->is_array()) fail_at(place(*value), key, words_of(value->type()), expected);
  return *value->as_array();
}

std::optional<std::vector<double>> TableReader::numbers(std::string_view key,
                                                        const Limits& each) const {
  note(key, NumberKey{NumberShape::kList, {each}});
  if (!has(key)) return std::nullopt;
  const toml::array& values = array(key, "an array of numbers");
  return tuple_of(values, std::string(key), std::vector<Limits>(values.size(), each));
}

std::vector<double> TableReader::tuple_of(const toml::array& values,
                                          const std::string& name,
                                          const std::vector<Limits>& limits) const {
  if (values.size() != limits.size())
    fail_at(place(values),
            name,
            fmt::format("an array of {}", values.size()),
            fmt::format("an array of {} numbers", limits.size()));
  std::vector<double> result;
  for (std::size_t i = 0; i < values.size(); ++i)
    result.push_back(checked_number(values[i], element_name(name, i), limits[i]));
  return result;
}

std::optional<std::vector<double>> TableReader::tuple(std::string_view key,
                                                      const std::vector<Limits>& limits) const {
  note(key, NumberKey{NumberShape::kTuple, limits});
  if (!has(key)) return std::nullopt;
  return tuple_of(
      array(key, fmt::format("an array of {} numbers", limits.size())), std::string(key), limits);
}

std::optional<std::vector<Vector3>> TableReader::points(std::string_view key,
                                                        const Limits& each) const {
  note(key, NumberKey{NumberShape::kPoints, {each, each, each}});
  if (!has(key)) return std::nullopt;
  const toml::array& values = array(key, "an array of [north, east, down]");
  std::vector<Vector3> result;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::string name = element_name(key, i);
    if (!values[i].is_array())
      fail_at(place(values[i]), name, words_of(values[i].type()), "an array of 3 numbers");
    const auto point = tuple_of(*values[i].as_array(), name, {each, each, each});
    result.emplace_back(point[0], point[1], point[2]);
  }
  return result;
}

TableReader TableReader::table(std::string_view key, const Keys& keys) const {
  const toml::node* const value = node(key);
  const std::string title = fmt::format("[{}]", key);
  if (!value) {
    TableReader absent(kAbsent, title, file_, keys, path_of(key));
    if (!path_.empty()) absent.where_ = where_;
    return absent;
  }
  if (value->is_array_of_tables())
    fail_at(place(*value), key, "an array of tables", title + ", with single brackets");
  if (!value->is_table()) fail_at(place(*value), key, words_of(value->type()), "a table: " + title);
  return TableReader(*value->as_table(), title, file_, keys, path_of(key));
}

std::vector<TableReader> TableReader::tables(std::string_view key, const Keys& keys) const {
  const toml::node* const value = node(key);
  if (!value) return {};
  const std::string title = fmt::format("[[{}]]", key);
  if (!value->is_array())
    fail_at(place(*value), key, words_of(value->type()), title + ", with double brackets");
  std::vector<TableReader> result;
  for (const toml::node& element : *value->as_array()) {
    if (!element.is_table())
      fail_at(place(element), key, words_of(element.type()), "a table: " + title);
    result.emplace_back(
        *element.as_table(), title, file_, keys, element_name(path_of(key), result.size()));
  }
  return result;
}

void TableReader::exclude(std::string_view key, const Keys& others) const {
  if (!has(key)) return;
  for (const std::string_view other : others) {
    if (!has(other)) continue;
    throw Error(fmt::format("{} and {} exclude each other; keep one of them", key, other),
                where(other));
  }
}

void TableReader::refuse(const Keys& keys, std::string_view kind) const {
  for (const std::string_view key : keys)
    if (has(key)) fail(key, fmt::format("{} has no effect with kind = \"{}\"", key, kind));
}

namespace {

// Numbers of open brackets and of dots in a key: far above a scene's two levels (table_reader.h).
constexpr int kDeepestBrackets = 32;
constexpr int kMaxDots = 16;

// The place behind a string that begins at `at`; adds the lines that it goes over to `line`.
std::size_t behind_string(std::string_view text, std::size_t at, int& line) {
  const char quote = text[at];
  const std::string three(3, quote);
  const bool multiline = text.substr(at).starts_with(three);
  const std::string end = multiline ? three : std::string(1, quote);
  at += end.size();
  while (at < text.size() && !text.substr(at).starts_with(end)) {
    if (text[at] == '\n') {
      if (!multiline) return at;
      ++line;
    }
    const bool is_escape =
        quote == '"' && text[at] == '\\' && at + 1 < text.size() && text[at + 1] != '\n';
    at += is_escape ? 2 : 1;
  }
  at += end.size();
  // A multi-line string may end in one or two quotes that belong to its text.
  while (multiline && at < text.size() && text[at] == quote) ++at;
  return at;
}

}  // namespace

// Scans TOML as its lexer does: it skips strings and comments. On text that is not TOML the scan
// and the parser may disagree, but only after the place where the parser stops.
void refuse_deep_nesting(std::string_view text, const std::string& file) {
  int line = 1, brackets = 0, dots = 0;
  for (std::size_t at = 0; at < text.size();) {
    const char c = text[at];
    if (c == '#') {
      at = std::min(text.find('\n', at), text.size());
      continue;
    }
    if (c == '"' || c == '\'') {
      at = behind_string(text, at, line);
      continue;
    }
    if (c == '[' || c == '{') ++brackets;
    if ((c == ']' || c == '}') && brackets > 0) --brackets;
    if (c == '.') ++dots;
    if (c == '\n' || c == ',' || c == '=' || c == '{' || c == '}') dots = 0;
    if (c == '\n') ++line;
    if (brackets > kDeepestBrackets || dots > kMaxDots)
      throw Error("is nested too deeply; a scene needs two levels", {file, line, 0});
    ++at;
  }
}

}  // namespace airtruth::scene
