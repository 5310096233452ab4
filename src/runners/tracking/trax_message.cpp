// SPDX-License-Identifier: Apache-2.0
#include "runners/tracking/trax_message.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

#include "foundation/base/names.h"
#include "foundation/base/text.h"
#include "labels/exchange/text.h"
#include "runners/process/child.h"
#include "runners/results/detections.h"
#include "runners/results/vot_regions.h"

namespace airtruth::tracking {
namespace {

// Characters; libtrax refuses longer keys.
constexpr std::size_t kMaxKey = 64;
constexpr std::string_view kMask = "mask:";
constexpr double kMaxPx = 1e9;  // far outside any picture

constexpr std::array<std::pair<std::string_view, Type>, 6> kTypes = {
    {{"hello", Type::kHello},
     {"initialize", Type::kInitialize},
     {"frame", Type::kFrame},
     {"state", Type::kState},
     {"status", Type::kState},
     {"quit", Type::kQuit}}};

bool is_key(std::string_view text) {
  return !text.empty() && text.size() <= kMaxKey &&
         std::all_of(text.begin(), text.end(), [](unsigned char c) {
           return std::isalnum(c) != 0 || c == '.' || c == '_';
         });
}

// One word from `rest` on, quotes and escapes taken off.
std::string next_word(std::string_view& rest) {
  const bool is_quoted = rest.front() == '"';
  if (is_quoted) rest.remove_prefix(1);
  std::string word;
  while (!rest.empty()) {
    const char c = rest.front();
    rest.remove_prefix(1);
    if (c == '\\' && !rest.empty()) {
      word += rest.front() == 'n' ? '\n' : rest.front();
      rest.remove_prefix(1);
    } else if (is_quoted ? c == '"' : c == ' ' || c == '\t') {
      return word;
    } else {
      word += c;
    }
  }
  if (is_quoted) throw process::Failure("sent a quote that is never closed");
  return word;
}

std::string in_quotes(std::string_view text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') result += '\\';
    if (c == '\n')
      result += "\\n";
    else
      result += c;
  }
  return result + "\"";
}

std::vector<double> numbers_of(std::string_view text) {
  std::vector<double> numbers;
  while (true) {
    const std::size_t end = std::min(text.find_first_of(",;"), text.size());
    std::string_view word = text.substr(0, end);
    while (!word.empty() && (word.front() == ' ' || word.front() == '+')) word.remove_prefix(1);
    while (!word.empty() && word.back() == ' ') word.remove_suffix(1);
    double value = 0;
    const auto [stop, fault] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (word.empty() || (fault != std::errc() && fault != std::errc::result_out_of_range) ||
        stop != word.data() + word.size())
      throw process::Failure("sent '" + std::string(word.substr(0, 40)) +
                             "', which is no number of a region");
    numbers.push_back(fault == std::errc() ? value : INFINITY);
    if (end == text.size()) return numbers;
    text.remove_prefix(end + 1);
  }
}

// Empty for what is no box in any picture.
std::optional<Box> sound(const std::optional<Box>& box) {
  const bool is_far =
      box && std::max({std::abs(box->x), std::abs(box->y), box->width, box->height}) >= kMaxPx;
  return box && results::is_sound(*box) && !is_far ? box : std::nullopt;
}

}  // namespace

std::string_view Message::property(std::string_view key) const {
  for (const auto& [name, value] : properties)
    if (name == key) return value;
  return {};
}

std::optional<Message> parse_line(std::string_view line) {
  if (!line.starts_with(kPrefix)) return std::nullopt;
  std::string_view rest = line.substr(kPrefix.size());
  if (!rest.empty() && rest.back() == '\r') rest.remove_suffix(1);
  const std::size_t end = std::min(rest.find_first_of(" \t"), rest.size());
  const std::string word = lower_case(rest.substr(0, end));
  const auto* type = std::ranges::find(kTypes, word, [](const auto& one) { return one.first; });
  if (type == kTypes.end())
    throw process::Failure("sent " + quoted_excerpt(rest.substr(0, end), 40) +
                           ", which is no type of message");
  rest.remove_prefix(end);
  Message message;
  message.type = type->second;
  while (true) {
    const std::size_t start = rest.find_first_not_of(" \t");
    if (start == std::string_view::npos) return message;
    rest.remove_prefix(start);
    std::string argument = next_word(rest);
    // "=" after what is no key, as in the padding of base64, is data.
    const std::size_t equals = argument.find('=');
    if (equals != std::string::npos && is_key(std::string_view(argument).substr(0, equals)))
      message.properties.emplace_back(argument.substr(0, equals), argument.substr(equals + 1));
    else
      message.arguments.push_back(std::move(argument));
  }
}

std::string line_of(const Message& message) {
  std::string line(kPrefix);
  line +=
      std::ranges::find(kTypes, message.type, [](const auto& one) { return one.second; })->first;
  for (const std::string& argument : message.arguments) line += " " + in_quotes(argument);
  for (const auto& [key, value] : message.properties) line += " " + in_quotes(key + "=" + value);
  return line + "\n";
}

std::optional<Box> box_of(std::string_view region) {
  if (region.starts_with(kMask)) {
    const std::vector<double> mask = numbers_of(region.substr(kMask.size()));
    if (const auto fault = results::fault_of_mask(mask))
      throw process::Failure("reported what " + *fault);
    return sound(exchange::bounds_of_mask(mask));
  }
  const std::vector<double> n = numbers_of(region);
  if (n.size() == 1) return std::nullopt;
  if (n.size() == 4) return sound(Box{n[0], n[1], n[2], n[3]});
  if (n.size() < 6 || n.size() % 2 != 0)
    throw process::Failure(fmt::format("sent a region of {} numbers", n.size()));
  return sound(results::bounds_of_polygon(n));
}

bool has_negative_side(std::string_view region) {
  if (region.starts_with(kMask)) return false;
  const std::vector<double> n = numbers_of(region);
  return n.size() == 4 && (n[2] < 0 || n[3] < 0);
}

std::string rectangle_of(const Box& box) {
  return fmt::format("{},{},{},{}", box.x, box.y, box.width, box.height);
}

std::string polygon_of(const Box& box) {
  return fmt::format("{0},{1},{2},{1},{2},{3},{0},{3}", box.x, box.y, box.right(), box.bottom());
}

std::string mask_of(const Box& box) {
  const auto whole = [](double v) { return static_cast<std::int64_t>(std::llround(v)); };
  const std::int64_t x = whole(box.x);
  const std::int64_t y = whole(box.y);
  const std::int64_t width = std::max<std::int64_t>(1, whole(box.right()) - x);
  const std::int64_t height = std::max<std::int64_t>(1, whole(box.bottom()) - y);
  return fmt::format("mask:{},{},{},{},0,{}", x, y, width, height, width * height);
}

}  // namespace airtruth::tracking
