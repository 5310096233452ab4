// SPDX-License-Identifier: Apache-2.0
#include "dataset/catalogue/table_values.h"

#include <fmt/format.h>

namespace airtruth::catalogue {

using scene::TableReader;

void expect_parts(const TableReader& table,
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

Range range_in(const TableReader& table, std::string_view key, const scene::Limits& limits) {
  const auto values = table.tuple(key, {limits, limits});
  if ((*values)[0] > (*values)[1])
    table.fail(key, std::string(key) + " falls; expected [low, high]");
  return {(*values)[0], (*values)[1]};
}

std::optional<Range> maybe_range(const TableReader& table,
                                 std::string_view key,
                                 const scene::Limits& limits) {
  if (!table.has(key)) return std::nullopt;
  return range_in(table, key, limits);
}

void read_range(const TableReader& table,
                std::string_view key,
                const scene::Limits& limits,
                Range& range) {
  range = maybe_range(table, key, limits).value_or(range);
}

std::optional<WholeRange> whole_range(const TableReader& table,
                                      std::string_view key,
                                      std::int64_t most) {
  if (!table.has(key)) return std::nullopt;
  if (!table.is_array(key)) {
    const std::int64_t number = *table.whole(key, 1, most);
    return WholeRange{number, number};
  }
  const std::string expected = fmt::format("a whole number from 1 to {}", most);
  const Range range =
      range_in(table, key, {.expected = expected, .low = 1, .high = static_cast<double>(most)});
  if (range.low != std::floor(range.low) || range.high != std::floor(range.high))
    table.fail(key, std::string(key) + " is no whole number; expected a number or [low, high]");
  return WholeRange{static_cast<std::int64_t>(range.low), static_cast<std::int64_t>(range.high)};
}

double drawn(Random& random, const Range& range) { return random.uniform(range.low, range.high); }

std::int64_t drawn(Random& random, const WholeRange& range) {
  const auto kinds = static_cast<double>(range.high - range.low + 1);
  return std::min(range.high, range.low + static_cast<std::int64_t>(random.uniform() * kinds));
}

double drawn_evenly_in_logarithm(Random& random, const Range& range) {
  return range.low * std::pow(range.high / range.low, random.uniform());
}

}  // namespace airtruth::catalogue
