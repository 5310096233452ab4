// SPDX-License-Identifier: Apache-2.0
#include "labels/exchange/text.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/base/text.h"
#include "foundation/geometry/box.h"
#include "labels/label_file/label_file.h"

namespace airtruth::exchange {
namespace {

std::optional<double> number_from(std::string_view text) {
  if (text == "nan" || text == "NaN" || text == "NAN")
    return std::numeric_limits<double>::quiet_NaN();
  return number_in(text);
}

}  // namespace

std::string number(double value) { return fmt::format("{}", value); }

std::optional<double> number_in(std::string_view text) {
  text = trimmed(text);
  if (text.starts_with('+')) text.remove_prefix(1);
  const auto value = number_from_text<double>(text);
  return value && std::isfinite(*value) ? value : std::nullopt;
}

bool is_there(const fs::path& file) {
  refuse_device(file);
  return fs::exists(file);
}

std::vector<Line> lines_of(const fs::path& file) {
  const std::string text = read_file(file);
  std::vector<Line> lines;
  int number = 0;
  bool is_behind_blank = false;
  for (std::size_t at = text.size() - without_mark(text).size(); at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    ++number;
    const std::string_view line = trimmed(std::string_view(text).substr(at, end - at));
    if (!line.empty() && line.front() != '#')
      lines.push_back({number, std::string(line), std::exchange(is_behind_blank, false)});
    is_behind_blank = is_behind_blank || line.empty();
    at = end + 1;
  }
  return lines;
}

std::vector<double> numbers_of(const Line& line, const fs::path& file) {
  std::vector<double> numbers;
  const std::string_view separators = ",; \t";
  const std::string_view text = line.text;
  const auto fail = [&](const std::string& what, std::size_t at) {
    throw Error(what, {file.string(), line.number, static_cast<int>(at) + 1});
  };
  if (text.find(',') != text.npos && text.find(';') != text.npos)
    fail("has commas between semicolons; expected decimal points", text.find(','));
  bool is_cell_empty = true;
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t end = std::min(text.find_first_of(separators, at), text.size());
    const std::string_view word = text.substr(at, end - at);
    if (!word.empty()) {
      const auto number = number_from(word);
      if (!number) fail(fmt::format("'{}' is not a number", word.substr(0, 40)), at);
      numbers.push_back(*number);
      is_cell_empty = false;
    }
    // Left out, it would move the numbers behind it.
    if (end < text.size() && (text[end] == ',' || text[end] == ';')) {
      if (is_cell_empty) fail("has an empty cell; expected a number", end);
      is_cell_empty = true;
    }
    at = end + 1;
  }
  return numbers;
}

std::map<std::string, std::string> settings_of(const fs::path& file) {
  std::map<std::string, std::string> settings;
  for (const Line& line : lines_of(file)) {
    const std::size_t equals = line.text.find('=');
    if (equals == std::string::npos) continue;
    settings[std::string(trimmed(line.text.substr(0, equals)))] =
        std::string(trimmed(line.text.substr(equals + 1)));
  }
  return settings;
}

std::optional<double> number_in(const std::map<std::string, std::string>& settings,
                                const std::string& key) {
  const auto found = settings.find(key);
  return found == settings.end() ? std::nullopt : number_from(found->second);
}

std::optional<std::int64_t> whole_in(double value, std::int64_t low, std::int64_t high) {
  const bool inside = value >= static_cast<double>(low) && value <= static_cast<double>(high);
  if (!inside || value != std::floor(value)) return std::nullopt;
  return static_cast<std::int64_t>(value);
}

int side_of(const std::optional<double>& value) {
  return static_cast<int>(value ? whole_in(*value, 1, label_file::kLongestSide_px).value_or(0) : 0);
}

std::string one_line(std::string text) {
  std::ranges::replace_if(text, is_control, ' ');
  return text;
}

std::pair<std::string, std::optional<std::int64_t>> name_and_number(const std::string& stem) {
  const std::size_t last = stem.find_last_not_of("0123456789");
  const std::size_t digits = last == std::string::npos ? 0 : last + 1;
  if (digits == stem.size() || stem.size() - digits > 15) return {stem, std::nullopt};
  std::int64_t number = 0;
  std::from_chars(stem.data() + digits, stem.data() + stem.size(), number);
  const bool parted = digits > 0 && (stem[digits - 1] == '_' || stem[digits - 1] == '-');
  return {stem.substr(0, parted ? digits - 1 : digits), number};
}

bool is_in_picture(const Box& box, int width, int height) {
  const bool sound = std::isfinite(box.x) && std::isfinite(box.y) && box.width > 0 &&
                     box.height > 0 && std::isfinite(box.right()) && std::isfinite(box.bottom());
  if (!sound) return false;
  if (width <= 0 || height <= 0) return true;
  return box.x < width && box.y < height && box.right() > 0 && box.bottom() > 0;
}

std::optional<Box> clipped(const Box& box, int width, int height) {
  if (!is_in_picture(box, width, height)) return std::nullopt;
  if (width <= 0 || height <= 0) return box;
  const double x = std::max(box.x, 0.0);
  const double y = std::max(box.y, 0.0);
  return Box{
      x, y, std::min(box.right(), double(width)) - x, std::min(box.bottom(), double(height)) - y};
}

std::optional<Box> bounds_of_mask(const std::vector<double>& n, int origin_px) {
  constexpr std::size_t kHead = 4;  // x, y, width, height
  const auto width = static_cast<std::int64_t>(n[2]);
  BoxBounds bounds;
  std::int64_t at = 0;
  for (std::size_t i = kHead; i < n.size(); ++i) {
    const auto run = static_cast<std::int64_t>(n[i]);
    if ((i - kHead) % 2 == 1 && run > 0) {
      const std::int64_t last = at + run - 1;
      const std::int64_t top = at / width, bottom = last / width;  // rows
      const bool is_one_row = top == bottom;
      const double left = is_one_row ? double(at % width) : 0;
      const double right = is_one_row ? double(last % width) : n[2] - 1;
      bounds.add({n[0] + left - origin_px, n[1] + double(top) - origin_px});
      bounds.add({n[0] + right + 1 - origin_px, n[1] + double(bottom) + 1 - origin_px});
    }
    at += run;
  }
  return bounds.box();
}

void LeftOut::add(const std::string& why, const std::string& first) {
  auto& [count, where] = found_[why];
  if (count++ == 0) where = first;
}

LeftOut::~LeftOut() {
  for (const auto& [why, found] : found_)
    warn(warn_, fmt::format("left out: {} {} (the first: {})", found.first, why, found.second));
}

}  // namespace airtruth::exchange
