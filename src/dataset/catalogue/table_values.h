// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "foundation/base/error.h"
#include "foundation/base/names.h"
#include "foundation/base/seed.h"
#include "scene/scene/table_reader.h"

// What the tables of a catalogue have in common: names of other tables, and ranges to draw from.
namespace airtruth::catalogue {

// Upper bound for every number of a frame in a catalogue: the length of its video bounds the cost.
constexpr std::int64_t kMost = 1'000'000'000;
// Most sequences of a rule, and of a catalogue: 0.5 TB of records and previews, and a minute to
// plan. Chosen.
constexpr std::int64_t kMostSequences = 1'000'000;
// Most intruders of a sequence: chosen.
constexpr std::int64_t kMaxIntruders = 100;

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
  throw Error("there is no " + std::string(what) + " '" + name + "'" + did_you_mean(name, names),
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
        !patterns || std::ranges::any_of(*patterns, [&](const std::string& pattern) {
          return matches(pattern, things[i].name);
        });
    if (wanted) result.push_back(i);
  }
  for (const std::string& pattern : patterns.value_or(std::vector<std::string>{})) {
    const bool used = std::ranges::any_of(
        things, [&](const auto& thing) { return matches(pattern, thing.name); });
    if (!used) place_of(things, pattern, what, table.where(key));
  }
  if (result.empty()) throw Error("there is no [[" + std::string(what) + "]]", table.where());
  return result;
}

// Throws Error where the pattern of names at the key `name` has a part in braces that is not one of
// `known`, such as "{index}".
void expect_parts(const scene::TableReader& table,
                  const std::string& pattern,
                  const std::vector<std::string>& known);

// Both ends belong to the range.
struct Range {
  double low = 0;
  double high = 0;
};
struct WholeRange {
  std::int64_t low = 1;
  std::int64_t high = 1;
};

// [low, high] at `key`, which is there.
Range range_in(const scene::TableReader& table, std::string_view key, const scene::Limits& limits);
// The range at `key`; empty where the key is absent.
std::optional<Range> maybe_range(const scene::TableReader& table,
                                 std::string_view key,
                                 const scene::Limits& limits);
// Takes the range at `key` where the key is there.
void read_range(const scene::TableReader& table,
                std::string_view key,
                const scene::Limits& limits,
                Range& range);
// A whole number from 1, or [low, high] of whole numbers; empty where the key is absent.
std::optional<WholeRange> whole_range(const scene::TableReader& table,
                                      std::string_view key,
                                      std::int64_t most);

double drawn(Random& random, const Range& range);
std::int64_t drawn(Random& random, const WholeRange& range);
// For sizes and distances: each factor of them is equally frequent.
double drawn_evenly_in_logarithm(Random& random, const Range& range);

// Of the things in their order, the one at a share of them from 0 up to 1.
template <typename T>
const T& one_at(double share, const std::vector<T>& things) {
  const auto at = static_cast<std::size_t>(share * static_cast<double>(things.size()));
  return things[std::min(at, things.size() - 1)];
}

template <typename T>
const T& one_of(Random& random, const std::vector<T>& things) {
  return one_at(random.uniform(), things);
}

}  // namespace airtruth::catalogue
