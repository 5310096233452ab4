// SPDX-License-Identifier: Apache-2.0
#include "picture/video/numbered_images.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <map>
#include <string>
#include <string_view>

#include "foundation/base/error.h"

namespace airtruth::video {
namespace {

namespace fs = std::filesystem;

constexpr std::array kEndings = {
    ".png", ".jpg", ".jpeg", ".bmp", ".tif", ".tiff", ".ppm", ".pgm", ".webp"};

bool is_digit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }

std::string_view without_zeros(std::string_view digits) {
  return digits.substr(std::min(digits.find_first_not_of('0'), digits.size()));
}

// Compares numbers of any length, such as 000000000139 or a time in nanoseconds: -1, 0 or 1.
int compare_digits(std::string_view a, std::string_view b) {
  a = without_zeros(a);
  b = without_zeros(b);
  if (a.size() != b.size()) return a.size() < b.size() ? -1 : 1;
  const int order = a.compare(b);
  return order < 0 ? -1 : order > 0 ? 1 : 0;
}

// True where `b` is the number after `a`.
bool follows(std::string_view a, std::string_view b) {
  // A leading zero takes the carry of 99.
  std::string next(a.size() + 1, '0');
  std::copy(a.begin(), a.end(), next.begin() + 1);
  std::size_t at = next.size() - 1;
  while (next[at] == '9') next[at--] = '0';
  ++next[at];
  return compare_digits(next, b) == 0;
}

// Compares names, with runs of digits as numbers.
bool comes_before(std::string_view a, std::string_view b) {
  const auto run = [](std::string_view text) {
    const auto end = std::find_if_not(text.begin(), text.end(), is_digit);
    return text.substr(0, static_cast<std::size_t>(end - text.begin()));
  };
  while (!a.empty() && !b.empty()) {
    const std::string_view digits_a = run(a);
    const std::string_view digits_b = run(b);
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

struct Numbered {
  std::string digits;
  fs::path file;
};

NumberedImages in_order(std::vector<Numbered> images) {
  std::sort(images.begin(), images.end(), [](const Numbered& a, const Numbered& b) {
    const int order = compare_digits(a.digits, b.digits);
    return order != 0 ? order < 0 : a.file < b.file;
  });
  NumberedImages result;
  for (std::size_t i = 0; i < images.size(); ++i) {
    if (i > 0 && !follows(images[i - 1].digits, images[i].digits)) result.has_gaps = true;
    result.files.push_back(images[i].file);
  }
  return result;
}

std::string ending_of(const fs::path& file) {
  std::string ending = file.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) {
    return std::tolower(c);
  });
  return std::find(kEndings.begin(), kEndings.end(), ending) != kEndings.end() ? ending : "";
}

// The group with the most pictures; among equal ones the first by its key.
template <typename Groups>
auto largest(const Groups& groups) {
  return std::max_element(groups.begin(), groups.end(), [](const auto& a, const auto& b) {
    return a.second.size() < b.second.size();
  });
}

std::optional<NumberedImages> in_folder(const fs::path& folder) {
  std::map<std::pair<std::string, std::string>, std::vector<Numbered>> series;
  std::map<std::string, std::vector<fs::path>> endings;
  std::size_t count = 0;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const fs::path name = entry.path().filename();
    const std::string ending = ending_of(name);
    if (ending.empty() || name.string().starts_with(".")) continue;
    ++count;
    endings[ending].push_back(entry.path());
    const std::string stem = name.stem().string();
    const std::size_t digits = stem.find_last_not_of("0123456789") + 1;
    if (digits < stem.size())
      series[{stem.substr(0, digits), name.extension().string()}].push_back(
          {stem.substr(digits), entry.path()});
  }
  if (count == 0) return std::nullopt;
  if (const auto found = largest(series); found != series.end() && 2 * found->second.size() > count)
    return in_order(found->second);
  NumberedImages result{largest(endings)->second, false};
  std::sort(result.files.begin(), result.files.end(), [](const fs::path& a, const fs::path& b) {
    return comes_before(a.filename().string(), b.filename().string());
  });
  return result;
}

// The position of a pattern's number: its first character and the one after its last.
std::optional<std::pair<std::size_t, std::size_t>> number_in_pattern(const std::string& name) {
  const auto percent = name.rfind('%');
  if (percent == std::string::npos) return std::nullopt;
  auto end = percent + 1;
  while (end < name.size() && is_digit(name[end])) ++end;
  if (end >= name.size() || name[end] != 'd') return std::nullopt;
  return std::pair(percent, end + 1);
}

NumberedImages of_pattern(const fs::path& path, std::size_t begin, std::size_t end) {
  const std::string name = path.filename().string();
  const std::string before = name.substr(0, begin);
  const std::string after = name.substr(end);
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  std::vector<Numbered> images;
  std::error_code ignored;
  if (fs::is_directory(folder, ignored))
    for (const auto& entry : fs::directory_iterator(folder)) {
      const std::string file = entry.path().filename().string();
      if (file.size() <= before.size() + after.size() || !file.starts_with(before) ||
          !file.ends_with(after))
        continue;
      const std::string digits = file.substr(begin, file.size() - before.size() - after.size());
      if (std::all_of(digits.begin(), digits.end(), is_digit))
        images.push_back({digits, entry.path()});
    }
  if (images.empty()) throw Error("matches no file; expected numbered images", {path.string()});
  return in_order(std::move(images));
}

}  // namespace

std::optional<NumberedImages> numbered_images(const fs::path& path) {
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) return in_folder(path);
  if (fs::exists(path, ignored)) return std::nullopt;
  const auto number = number_in_pattern(path.filename().string());
  if (!number) return std::nullopt;
  return of_pattern(path, number->first, number->second);
}

}  // namespace airtruth::video
