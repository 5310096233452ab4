// SPDX-License-Identifier: Apache-2.0
#include "video/numbered_images.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdio>
#include <vector>

#include "base/error.h"

namespace airtruth::video {
namespace {

namespace fs = std::filesystem;

constexpr std::array kEndings = {
    ".png", ".jpg", ".jpeg", ".bmp", ".tif", ".tiff", ".ppm", ".pgm", ".webp"};

// "img_00012.png" -> "img_", "00012", ".png"
struct Split {
  std::string before, digits, after;
};

std::optional<Split> split(const fs::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(), [](unsigned char c) {
    return std::tolower(c);
  });
  if (std::find(kEndings.begin(), kEndings.end(), extension) == kEndings.end()) return std::nullopt;
  const std::string stem = file.stem().string();
  std::size_t begin = stem.size();
  while (begin > 0 && std::isdigit(static_cast<unsigned char>(stem[begin - 1])) != 0) --begin;
  if (begin == stem.size() || stem.size() - begin > 9) return std::nullopt;
  return Split{stem.substr(0, begin), stem.substr(begin), file.extension().string()};
}

std::string escaped(const std::string& text) {
  std::string result;
  for (char c : text) result += c == '%' ? "%%" : std::string(1, c);
  return result;
}

std::optional<NumberedImages> in_folder(const fs::path& folder) {
  std::optional<Split> first;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const auto parts = split(entry.path().filename());
    if (parts && (!first || std::stoi(parts->digits) < std::stoi(first->digits))) first = parts;
  }
  if (!first) return std::nullopt;
  const std::string number =
      first->digits.size() > 1 ? "%0" + std::to_string(first->digits.size()) + "d" : "%d";
  return NumberedImages{
      escaped(folder.string()) + "/" + escaped(first->before) + number + escaped(first->after),
      std::stoi(first->digits)};
}

bool is_pattern(const std::string& name) {
  const auto percent = name.find('%');
  if (percent == std::string::npos) return false;
  auto end = percent + 1;
  while (end < name.size() && std::isdigit(static_cast<unsigned char>(name[end])) != 0) ++end;
  return end < name.size() && name[end] == 'd' && name.find('%', end) == std::string::npos;
}

}  // namespace

std::optional<NumberedImages> numbered_images(const fs::path& path) {
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) return in_folder(path);
  if (fs::exists(path, ignored) || !is_pattern(path.filename().string())) return std::nullopt;
  const std::string name = path.filename().string();
  const auto percent = name.find('%');
  const auto end = name.find('d', percent);
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  std::optional<int> first;
  if (fs::is_directory(folder, ignored)) {
    for (const auto& entry : fs::directory_iterator(folder)) {
      const std::string file = entry.path().filename().string();
      const std::size_t tail = name.size() - end - 1;
      if (file.rfind(name.substr(0, percent), 0) != 0 || file.size() <= percent + tail) continue;
      const std::string digits = file.substr(percent, file.size() - percent - tail);
      if (digits.empty() || digits.size() > 9 ||
          !std::all_of(
              digits.begin(), digits.end(), [](unsigned char c) { return std::isdigit(c) != 0; }))
        continue;
      const int number = std::stoi(digits);
      if (!first || number < *first) first = number;
    }
  }
  if (!first) throw Error("matches no file; expected numbered images", {path.string()});
  return NumberedImages{path.string(), *first};
}

}  // namespace airtruth::video
