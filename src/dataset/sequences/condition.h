// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

// What is asked of the weather of sequences (scene::weather_facts() of their scenes).
namespace airtruth::sequences {

// One key within a range; both ends belong to it.
struct Condition {
  std::string text;  // "KEY=LOW..HIGH"
  std::string key;
  double low = 0;
  double high = 0;
};

// Parses "KEY=LOW..HIGH", where one of LOW and HIGH may be left out, as of "noise=1.5..". Throws
// Error that names the nearest key.
Condition condition_from(const std::string& text);

// True where the facts have every key, within its range.
bool hold(const std::vector<Condition>& conditions, const std::map<std::string, double>& facts);

}  // namespace airtruth::sequences
