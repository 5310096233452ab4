// SPDX-License-Identifier: Apache-2.0
#include "foundation/picture_series/series.h"

#include <algorithm>
#include <array>
#include <map>
#include <numeric>

#include "foundation/base/files.h"
#include "foundation/base/names.h"

namespace airtruth::picture_series {
namespace {

constexpr std::array kPictureEndings = {
    ".png", ".jpg", ".jpeg", ".bmp", ".tif", ".tiff", ".ppm", ".pgm", ".webp"};

constexpr std::string_view kDigits = "0123456789";
constexpr std::string_view kHexDigits = "0123456789abcdefABCDEF";

std::string_view digits_at_begin(std::string_view text) {
  return text.substr(0, std::min(text.find_first_not_of(kDigits), text.size()));
}

std::string_view without_zeros(std::string_view digits) {
  return digits.substr(std::min(digits.find_first_not_of('0'), digits.size()));
}

// Compares numbers of any length, such as a time in nanoseconds: -1, 0 or 1.
int compare_digits(std::string_view a, std::string_view b) {
  a = without_zeros(a);
  b = without_zeros(b);
  if (a.size() != b.size()) return a.size() < b.size() ? -1 : 1;
  const int order = a.compare(b);
  return order < 0 ? -1 : order > 0 ? 1 : 0;
}

// The name without its ending and without Roboflow's suffix.
std::string stem_of(const std::string& name) {
  std::string stem = fs::path(name).stem().string();
  const std::size_t suffix = stem.rfind(".rf.");
  if (suffix != std::string::npos && suffix + 4 < stem.size() &&
      stem.find_first_not_of(kHexDigits, suffix + 4) == std::string::npos)
    stem.resize(suffix);
  return stem;
}

// A name with '#' for each run of digits, and the runs.
struct Scheme {
  std::string text;
  std::vector<std::string> numbers;
};

Scheme scheme_of(const std::string& name) {
  Scheme scheme;
  const std::string stem = stem_of(name);
  for (std::size_t at = 0; at < stem.size();) {
    const std::string_view digits = digits_at_begin(std::string_view(stem).substr(at));
    if (digits.empty()) {
      scheme.text += stem[at++];
      continue;
    }
    scheme.text += '#';
    scheme.numbers.emplace_back(digits);
    at += digits.size();
  }
  scheme.text += lower_case(fs::path(name).extension().string());
  return scheme;
}

// True where the last number of a name is 0 or 1.
bool begins_counting(const Scheme& scheme) {
  if (scheme.numbers.empty()) return false;
  const std::string_view last = without_zeros(scheme.numbers.back());
  return last.empty() || last == "1";
}

// The pictures of one scheme, split where the last number begins anew at 0 or 1.
std::vector<Series> split(const Series& same_scheme, const std::vector<Scheme>& schemes) {
  std::map<std::vector<std::string>, Series> by_first_numbers;
  for (const std::size_t i : same_scheme) {
    std::vector<std::string> first = schemes[i].numbers;
    if (!first.empty()) first.pop_back();
    by_first_numbers[first].push_back(i);
  }
  std::vector<Series> parts;
  for (const auto& [first, part] : by_first_numbers) {
    if (!begins_counting(schemes[part.front()])) return {same_scheme};
    parts.push_back(part);
  }
  return parts;
}

}  // namespace

bool is_picture_file(const fs::path& file) {
  const std::string ending = lower_case(file.extension().string());
  return std::find(kPictureEndings.begin(), kPictureEndings.end(), ending) != kPictureEndings.end();
}

std::vector<std::string> pictures_in(const fs::path& folder) {
  std::vector<std::string> names;
  for (const fs::path& file : entries(folder)) {
    if (!is_picture_file(file)) continue;
    refuse_device(file);
    names.push_back(file.filename().string());
  }
  return names;
}

bool is_numbered_before(std::string_view a, std::string_view b) {
  while (!a.empty() && !b.empty()) {
    const std::string_view digits_a = digits_at_begin(a);
    const std::string_view digits_b = digits_at_begin(b);
    if (!digits_a.empty() && !digits_b.empty()) {
      if (const int order = compare_digits(digits_a, digits_b); order != 0) return order < 0;
      a.remove_prefix(digits_a.size());
      b.remove_prefix(digits_b.size());
      continue;
    }
    if (a.front() != b.front()) return a.front() < b.front();
    a.remove_prefix(1);
    b.remove_prefix(1);
  }
  return a.empty() && !b.empty();
}

std::vector<Series> series_of(std::span<const std::string> names, Stray stray) {
  std::vector<Scheme> schemes;
  for (const std::string& name : names) schemes.push_back(scheme_of(name));
  Series order(names.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return is_numbered_before(names[a], names[b]);
  });
  std::map<std::string, Series> by_scheme;
  for (const std::size_t i : order) by_scheme[schemes[i].text].push_back(i);
  std::vector<Series> all;
  std::size_t strays = 0;
  for (const auto& [scheme, group] : by_scheme)
    for (Series& part : split(group, schemes)) {
      strays += part.size() == 1 && !begins_counting(schemes[part.front()]) ? 1 : 0;
      all.push_back(std::move(part));
    }
  const bool are_one = stray == Stray::kOfOneSeries ? strays > 0 : strays == all.size();
  if (are_one && !names.empty()) return {order};
  return all;
}

std::string common_name(std::span<const std::string> names) {
  if (names.empty()) return {};
  std::string common = stem_of(names.front());
  for (const std::string& name : names) {
    const std::string stem = stem_of(name);
    const auto differs =
        std::mismatch(common.begin(), common.end(), stem.begin(), stem.end()).first;
    common.erase(differs, common.end());
  }
  // The number that counts may begin with digits that all names share.
  common.resize(common.find_last_not_of(kDigits) + 1);
  common.resize(common.find_last_not_of("_-. ") + 1);
  return common;
}

}  // namespace airtruth::picture_series
