// SPDX-License-Identifier: Apache-2.0
#include "runners/results/json_list.h"

#include <algorithm>
#include <utility>

#include "foundation/base/error.h"

namespace airtruth::results {
namespace {

// A place in a text, with its line.
struct Cursor {
  std::string_view text;
  std::size_t at = 0;
  int line = 1;

  bool is_at_end() const { return at >= text.size(); }
  char here() const { return is_at_end() ? '\0' : text[at]; }
  void step() { line += text[at++] == '\n' ? 1 : 0; }
  void skip_blanks() {
    while (!is_at_end() && std::string_view(" \t\r\n").find(here()) != std::string_view::npos)
      step();
  }
  // From the quote on to after the one that closes; false where none does.
  bool skip_string() {
    step();
    while (!is_at_end() && here() != '"') {
      if (here() == '\\') step();
      if (!is_at_end()) step();
    }
    if (is_at_end()) return false;
    step();
    return true;
  }
  // To the comma or bracket after the value; false where there is none.
  bool skip_value() {
    int depth = 0;
    while (!is_at_end()) {
      const char c = here();
      if (c == '"') {
        if (!skip_string()) return false;
        continue;
      }
      const bool closes = c == ']' || c == '}';
      if (depth == 0 && (c == ',' || closes)) return true;
      if (c == '[' || c == '{') ++depth;
      if (closes) --depth;
      step();
    }
    return false;
  }
  // The value from here on; empty where it does not end.
  std::optional<JsonPart> value() {
    const std::size_t begin = at;
    const int first = line;
    if (!skip_value()) return std::nullopt;
    return JsonPart{text.substr(begin, at - begin), first};
  }
};

[[noreturn]] void not_whole(const std::filesystem::path& file, int line) {
  throw Error("the object does not end: the file is not whole", {file.string(), line});
}

}  // namespace

JsonElements::JsonElements(const JsonPart& whole,
                           const std::filesystem::path& file,
                           std::string what)
    : text_(whole.text), file_(file), what_(std::move(what)), line_(whole.line) {
  Cursor cursor{text_, 0, line_};
  cursor.skip_blanks();
  line_ = cursor.line;
  if (cursor.here() != '[') fail("is no list of " + what_);
  cursor.step();
  at_ = cursor.at;
}

std::optional<JsonPart> JsonElements::next() {
  Cursor cursor{text_, at_, line_};
  const auto move = [&] { at_ = cursor.at, line_ = cursor.line; };
  cursor.skip_blanks();
  move();
  if (cursor.here() == ',' && !is_first_) {
    cursor.step();
    cursor.skip_blanks();
  } else if (cursor.here() == ']') {
    cursor.step();
    cursor.skip_blanks();
    move();
    if (!cursor.is_at_end()) fail("goes on after the list of " + what_);
    return std::nullopt;
  } else if (!is_first_) {
    fail("the list of " + what_ + " does not end; expected ',' or ']'");
  }
  is_first_ = false;
  const auto part = cursor.value();
  move();
  if (!part) fail("ends within the list of " + what_ + ": the file is not whole");
  return part;
}

void JsonElements::fail(const std::string& fault) const {
  throw Error(fault, {file_.string(), line_});
}

std::vector<std::optional<JsonPart>> json_members(std::string_view text,
                                                  const std::filesystem::path& file,
                                                  const std::vector<std::string>& keys) {
  std::vector<std::optional<JsonPart>> members(keys.size());
  Cursor cursor{text};
  cursor.skip_blanks();
  if (cursor.here() != '{') throw Error("is no JSON object", {file.string(), cursor.line});
  cursor.step();
  for (bool is_first = true;; is_first = false) {
    cursor.skip_blanks();
    if (cursor.here() == '}') break;
    if (cursor.here() == ',' && !is_first) {
      cursor.step();
      cursor.skip_blanks();
    }
    if (cursor.here() != '"')
      throw Error("has no key here; expected a key, ',' or '}'", {file.string(), cursor.line});
    const std::size_t begin = cursor.at + 1;
    const int line = cursor.line;
    if (!cursor.skip_string()) not_whole(file, line);
    const std::string_view key = text.substr(begin, cursor.at - 1 - begin);
    cursor.skip_blanks();
    if (cursor.here() != ':')
      throw Error("has no value of a key; expected ':'", {file.string(), cursor.line});
    cursor.step();
    cursor.skip_blanks();
    const auto value = cursor.value();
    if (!value) not_whole(file, line);
    const auto found = std::find(keys.begin(), keys.end(), key);
    if (found == keys.end()) continue;
    auto& member = members[static_cast<std::size_t>(found - keys.begin())];
    if (member) throw Error("has '" + *found + "' twice", {file.string(), line});
    member = value;
  }
  cursor.step();
  cursor.skip_blanks();
  if (!cursor.is_at_end()) throw Error("goes on after the object", {file.string(), cursor.line});
  return members;
}

}  // namespace airtruth::results
