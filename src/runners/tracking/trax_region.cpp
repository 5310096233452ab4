// SPDX-License-Identifier: Apache-2.0
#include "runners/tracking/trax_region.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <vector>

#include <fmt/format.h>

#include "runners/process/child.h"
#include "runners/tracking/trax_message.h"

namespace airtruth::tracking {
namespace {

constexpr std::string_view kMask = "mask:";
constexpr double kMaxSide = 1 << 20;

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
      throw process::Failure("'" + std::string(word.substr(0, 40)) + "' is no number of a region");
    numbers.push_back(fault == std::errc() ? value : INFINITY);
    if (end == text.size()) return numbers;
    text.remove_prefix(end + 1);
  }
}

std::optional<Box> sound(const Box& box) {
  const bool is_sound = std::isfinite(box.x + box.y + box.width + box.height) && box.width > 0 &&
                        box.height > 0 &&
                        std::max({std::abs(box.x), std::abs(box.y), box.width, box.height}) < 1e9;
  return is_sound ? std::optional(box) : std::nullopt;
}

std::optional<Box> bounds_of_mask(const std::vector<double>& n) {
  if (n.size() < 4) throw process::Failure("a mask has fewer than four numbers");
  for (const double value : n)
    if (!(std::abs(value) <= kMaxSide * kMaxSide) || value != std::floor(value))
      throw process::Failure("a mask holds what is no whole number");
  if (n[2] < 0 || n[3] < 0 || n[2] > kMaxSide || n[3] > kMaxSide)
    throw process::Failure("a mask's size is out of all bounds");
  const auto width = static_cast<std::int64_t>(n[2]);
  const std::int64_t most = width * static_cast<std::int64_t>(n[3]);
  BoxBounds bounds;
  std::int64_t at = 0;
  for (std::size_t i = 4; i < n.size(); ++i) {
    const auto run = static_cast<std::int64_t>(n[i]);
    if (run < 0 || run > most - at)
      throw process::Failure("a mask's runs are longer than the mask");
    if (i % 2 == 1 && run > 0) {
      const std::int64_t first = at / width;
      const std::int64_t last = (at + run - 1) / width;
      const std::int64_t left = first == last ? at % width : 0;
      const std::int64_t right = first == last ? (at + run - 1) % width : width - 1;
      bounds.add({n[0] + double(left), n[1] + double(first)});
      bounds.add({n[0] + double(right) + 1, n[1] + double(last) + 1});
    }
    at += run;
  }
  return bounds.box();
}

}  // namespace

std::optional<Box> box_of(std::string_view region) {
  if (region.starts_with(kMask)) {
    const auto box = bounds_of_mask(numbers_of(region.substr(kMask.size())));
    return box ? sound(*box) : std::nullopt;
  }
  const std::vector<double> n = numbers_of(region);
  if (n.size() == 1) return std::nullopt;
  if (n.size() == 4) return sound({n[0], n[1], n[2], n[3]});
  if (n.size() < 6 || n.size() % 2 != 0)
    throw process::Failure(fmt::format("a region has {} numbers", n.size()));
  BoxBounds bounds;
  for (std::size_t i = 0; i < n.size(); i += 2) {
    if (!std::isfinite(n[i] + n[i + 1])) return std::nullopt;
    bounds.add({n[i], n[i + 1]});
  }
  return sound(bounds.box().value());
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
