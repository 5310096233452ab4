// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <toml++/toml.h>

#include "foundation/base/error.h"
#include "foundation/geometry/transform.h"
#include "world/scene/limits.h"

// Reads a table of a TOML file strictly: what is there must be known, of the right type and in
// range, or an Error says so at its line and column. For the readers of TOML files; not installed.
namespace airtruth::scene {

class TableReader {
 public:
  using Keys = std::initializer_list<std::string_view>;

  // `title` is how messages call the table: "[lens]". Throws where the table holds a key that is
  // not in `keys`.
  // `path` is the table's place in the file as a KeyLog has it: "background[0].lens", "" at the
  // top.
  TableReader(const toml::table& table,
              std::string title,
              const std::string& file,
              Keys keys,
              std::string path = "");

  bool has(std::string_view key) const;
  bool says(std::string_view key, std::string_view word) const;  // is the value this very string?
  bool is_array(std::string_view key) const;                     // is the value an array?
  Where where() const;                      // the table's; no line where the file lacks the table
  Where where(std::string_view key) const;  // the value's

  // Each is empty where the key is absent.
  std::optional<double> number(std::string_view key, const Limits& limits) const;
  std::optional<std::int64_t> whole(std::string_view key,
                                    std::int64_t low,
                                    std::int64_t high) const;
  std::optional<bool> truth(std::string_view key) const;
  std::optional<std::string> text(std::string_view key) const;  // not empty, no control characters
  // An array of at least one such text.
  std::optional<std::vector<std::string>> texts(std::string_view key) const;
  std::optional<std::string> file_name(std::string_view key) const;  // a text with no folder in it
  std::optional<std::string> choice(std::string_view key, Keys choices) const;
  // Relative paths are taken from the folder of the scene file.
  std::optional<std::filesystem::path> path(std::string_view key) const;
  std::optional<std::vector<double>> numbers(std::string_view key, const Limits& each) const;
  // One limit for each number: exactly so many are expected.
  std::optional<std::vector<double>> tuple(std::string_view key,
                                           const std::vector<Limits>& limits) const;
  std::optional<Vector3> vector(std::string_view key, const Limits& each) const;
  std::optional<std::vector<Vector3>> points(std::string_view key, const Limits& each) const;

  // A table inside; an empty one where absent.
  TableReader table(std::string_view key, Keys keys) const;
  // The tables of [[key]].
  std::vector<TableReader> tables(std::string_view key, Keys keys) const;

  // Throws where `key` and any of `others` are both there.
  void exclude(std::string_view key, Keys others) const;
  [[noreturn]] void fail(std::string_view key, std::string_view message) const;
  // The place of element i of the array at `key`.
  Where where(std::string_view key, std::size_t i) const;

 private:
  const toml::node* node(std::string_view key) const;
  std::string path_of(std::string_view key) const;
  Where place(const toml::node& node) const;
  double checked_number(const toml::node& node,
                        const std::string& name,
                        const Limits& limits) const;
  const toml::array& array(std::string_view key, std::string_view expected) const;
  std::vector<double> tuple_of(const toml::array& array,
                               const std::string& name,
                               const std::vector<Limits>& limits) const;
  void refuse_unknown() const;

  const toml::table* table_;
  std::string title_;
  std::string path_;
  std::string file_;
  std::vector<std::string> keys_;
};

// Is it a name that a file in any folder could have? Not empty, no slash, no control character, not
// "." or "..".
bool is_plain_file_name(std::string_view name);

// A number as a message shows it: the shortest text that gives it back.
std::string shown(double number);

}  // namespace airtruth::scene
