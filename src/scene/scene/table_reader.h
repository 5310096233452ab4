// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <toml++/toml.h>

#include "foundation/base/error.h"
#include "foundation/base/names.h"
#include "foundation/geometry/transform.h"
#include "scene/scene/limits.h"

// Reads a table of a TOML file strictly: every key must be known, of the right type and in range.
// Otherwise an Error names the line and column. Only readers of TOML files use this header; it is
// not installed.
namespace airtruth::scene {

enum class NumberShape { kOne, kList, kTuple, kPoints };

struct NumberKey {
  NumberShape shape = NumberShape::kOne;
  // One range for all numbers, or one for each place of a tuple or point.
  std::vector<Limits> limits;
};
struct WholeKey {
  std::int64_t low = 0;
  std::int64_t high = 0;
};

// What a reader does with a key: a table may have it; it is read; it is read as a number.
struct KnownKey {};
struct ReadKey {};
using KeyUse = std::variant<KnownKey, ReadKey, NumberKey, WholeKey>;

// While it is set, every TableReader of the thread calls it for each use of a key, so that a test
// can visit every key of a format without its own list. A key is named by its path:
// "background[0].lens.focal_px".
void call_on_key_use(std::function<void(const std::string& path, const KeyUse& use)> call);

class TableReader {
 public:
  using Keys = std::vector<std::string_view>;

  // Throws where the table holds a key that is not in `keys`. `title` is the table's name in
  // messages: "[lens]". `path` is the table's place in the file, as call_on_key_use() has it:
  // "background[0].lens", "" at the top.
  TableReader(const toml::table& table,
              std::string title,
              const std::string& file,
              const Keys& keys,
              std::string path = "");

  bool has(std::string_view key) const;
  // True where the value is exactly this string.
  bool says(std::string_view key, std::string_view word) const;
  // True where the value is an array; a table.
  bool is_array(std::string_view key) const;
  bool is_table(std::string_view key) const;
  // The place of the table. Where the file lacks it, that of the table which could hold it; without
  // a line at the top of the file.
  Where where() const;
  // The place of the value.
  Where where(std::string_view key) const;

  // Each of the following readers returns empty where the key is absent.
  std::optional<double> number(std::string_view key, const Limits& limits) const;
  std::optional<std::int64_t> whole(std::string_view key,
                                    std::int64_t low,
                                    std::int64_t high) const;
  std::optional<bool> truth(std::string_view key) const;
  // A string that is not empty and holds no control characters.
  std::optional<std::string> text(std::string_view key) const;
  // An array of at least one such string.
  std::optional<std::vector<std::string>> texts(std::string_view key) const;
  // A string without a folder in it.
  std::optional<std::string> file_name(std::string_view key) const;
  std::optional<std::string> choice(std::string_view key,
                                    const std::vector<std::string>& choices) const;
  // A word that names a value of the enum (foundation/base/names.h).
  template <typename Enum>
  std::optional<Enum> choice(std::string_view key) const {
    const auto word = choice(key, all_enum_names<Enum>());
    return word ? enum_named<Enum>(*word) : std::nullopt;
  }
  // A file path. A relative path is resolved against the folder of the scene file.
  std::optional<std::filesystem::path> path(std::string_view key) const;
  std::optional<std::vector<double>> numbers(std::string_view key, const Limits& each) const;
  // An array of exactly one number for each element of `limits`.
  std::optional<std::vector<double>> tuple(std::string_view key,
                                           const std::vector<Limits>& limits) const;
  // The same as an array of fixed size, such as Vector3 or std::array<double, 2>, with one range.
  template <typename Array>
  std::optional<Array> tuple(std::string_view key, const Limits& each) const {
    Array array{};
    const auto values =
        tuple(key, std::vector<Limits>(static_cast<std::size_t>(array.size()), each));
    if (!values) return std::nullopt;
    auto value = values->begin();
    for (double& number : array) number = *value++;
    return array;
  }
  std::optional<std::vector<Vector3>> points(std::string_view key, const Limits& each) const;

  // The table at `key`; an empty table where it is absent.
  TableReader table(std::string_view key, const Keys& keys) const;
  // The tables of the array [[key]].
  std::vector<TableReader> tables(std::string_view key, const Keys& keys) const;

  // Throws where the table holds both `key` and any of `others`.
  void exclude(std::string_view key, const Keys& others) const;
  // Throws where the table holds any of the keys, which have no effect with this kind.
  void refuse(const Keys& keys, std::string_view kind) const;
  [[noreturn]] void fail(std::string_view key, std::string_view message) const;
  // The place of element i of the array at `key`.
  Where where(std::string_view key, std::size_t i) const;

 private:
  const toml::node* node(std::string_view key) const;
  std::string path_of(std::string_view key) const;
  void note(std::string_view key, const KeyUse& use) const;
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
  Where where_;
  std::vector<std::string> keys_;
};

// Keys from one text, with blanks between them: keys("name seed weight").
TableReader::Keys keys(std::string_view words);

// A text of the file as messages show it: in quotes, shortened to fit one line and without control
// characters.
std::string in_quotes(std::string_view text);

// Throws Error where the text nests deeper than any scene does: arrays in arrays, or
// a.long.dotted.key. The TOML parser and the destructors of its result are recursive, so a hostile
// file could otherwise exhaust the stack.
void refuse_deep_nesting(std::string_view text, const std::string& file);

}  // namespace airtruth::scene
