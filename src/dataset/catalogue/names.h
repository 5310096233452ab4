// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "dataset/catalogue/expand.h"
#include "foundation/base/error.h"
#include "foundation/base/pattern.h"
#include "foundation/base/suggest.h"
#include "scene/scene/table_reader.h"

// Look-up of the names in a catalogue's tables, for the readers of catalogues.
namespace airtruth::dataset {

// Upper bound for every count in a catalogue.
constexpr std::int64_t kMost = 1'000'000'000;

// Returns the index of the thing with that name. Throws Error at `where` with the nearest spelling.
template <typename Things>
std::size_t place_of(const Things& things,
                     const std::string& name,
                     const char* what,
                     const Where& where) {
  std::vector<std::string> names;
  for (const auto& thing : things) names.push_back(thing.name);
  const auto found = std::find(names.begin(), names.end(), name);
  if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
  const auto nearest = nearest_spelling(name, names);
  throw Error("there is no " + std::string(what) + " '" + name + "'" +
                  (nearest ? "; did you mean '" + *nearest + "'?" : ""),
              where);
}

// Returns the indices of the things whose names match a pattern of the array at `key`; all of them
// where the key is absent.
template <typename Things>
std::vector<std::size_t> places_of(const scene::TableReader& table,
                                   std::string_view key,
                                   const Things& things,
                                   const char* what) {
  std::vector<std::size_t> result;
  const auto patterns = table.texts(key);
  for (std::size_t i = 0; i < things.size(); ++i) {
    const bool wanted =
        !patterns ||
        std::any_of(patterns->begin(), patterns->end(), [&](const std::string& pattern) {
          return matches(pattern, things[i].name);
        });
    if (wanted) result.push_back(i);
  }
  for (const std::string& pattern : patterns.value_or(std::vector<std::string>{})) {
    const bool used = std::any_of(things.begin(), things.end(), [&](const auto& thing) {
      return matches(pattern, thing.name);
    });
    if (!used) place_of(things, pattern, what, table.where(key));
  }
  if (result.empty()) throw Error("there is no [[" + std::string(what) + "]]", table.where());
  return result;
}

// Throws Error where the pattern of names at the key `name` has a part in braces that is not one of
// `known`, such as "{index}".
inline void expect_parts(const scene::TableReader& table,
                         const std::string& pattern,
                         const std::vector<std::string>& known) {
  for (std::size_t from = pattern.find('{'); from != std::string::npos;
       from = pattern.find('{', from + 1)) {
    const std::size_t end = pattern.find('}', from);
    const std::string part = pattern.substr(from, end == std::string::npos ? end : end + 1 - from);
    if (std::find(known.begin(), known.end(), part) != known.end()) continue;
    std::string expected;
    for (const std::string& one : known) expected += (expected.empty() ? "" : ", ") + one;
    table.fail("name", "name has the part '" + part + "'; expected " + expected);
  }
}

}  // namespace airtruth::dataset
