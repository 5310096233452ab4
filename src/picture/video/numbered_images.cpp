// SPDX-License-Identifier: Apache-2.0
#include "picture/video/numbered_images.h"

#include <algorithm>
#include <cctype>
#include <string_view>

#include <fmt/format.h>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/base/text.h"
#include "foundation/picture_series/series.h"

namespace airtruth::video {
namespace {

// Of a list of pictures: a million paths of 100 bytes.
constexpr std::size_t kMaxListBytes = 100'000'000;

bool is_digit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }

// True where `b` is the number after `a`.
bool follows(std::string_view a, std::string_view b) {
  // A leading zero takes the carry of 99.
  std::string next(a.size() + 1, '0');
  std::copy(a.begin(), a.end(), next.begin() + 1);
  std::size_t at = next.size() - 1;
  while (next[at] == '9') next[at--] = '0';
  ++next[at];
  return !picture_series::is_numbered_before(next, b) &&
         !picture_series::is_numbered_before(b, next);
}

// Where a name's last digits begin; its end where it does not end in one.
std::size_t last_digits_of(const std::string& stem) {
  return stem.find_last_not_of("0123456789") + 1;
}

// Files in the order of their frames. A gap is seen where all names end in the number that counts.
NumberedImages in_order(std::vector<fs::path> files) {
  NumberedImages result{std::move(files)};
  for (std::size_t i = 1; i < result.files.size() && result.doubt == nullptr; ++i) {
    const std::string before = result.files[i - 1].stem().string();
    const std::string stem = result.files[i].stem().string();
    const std::size_t digits = last_digits_of(stem);
    if (digits == stem.size() || before.substr(0, last_digits_of(before)) != stem.substr(0, digits))
      return {std::move(result.files)};
    if (!follows(before.substr(digits), stem.substr(digits)))
      result.doubt = "gaps between the numbers";
  }
  return result;
}

// "vidA_000.jpg and 3 like it": what a folder holds beside other series.
std::string words_of(const picture_series::Series& series, const std::vector<std::string>& names) {
  const std::string& first = names[series.front()];
  return series.size() == 1 ? first : fmt::format("{} and {} like it", first, series.size() - 1);
}

std::optional<NumberedImages> in_folder(const fs::path& folder) {
  const std::vector<std::string> names = picture_series::pictures_in(folder);
  if (names.empty()) return std::nullopt;
  const std::vector<picture_series::Series> all =
      picture_series::series_of(names, picture_series::Stray::kApart);
  if (all.size() > 1)
    throw Error(
        fmt::format("holds pictures of {} series ({}; {}{}); expected one; a pattern such as "
                    "frames/%06d.png or a list of pictures (list.txt) states which",
                    all.size(),
                    words_of(all[0], names),
                    words_of(all[1], names),
                    all.size() > 2 ? "; ..." : ""),
        {folder.string()});
  std::vector<fs::path> files;
  for (const std::size_t i : all.front()) files.push_back(folder / names[i]);
  NumberedImages images = in_order(std::move(files));
  const auto has_number = [](const std::string& name) {
    return fs::path(name).stem().string().find_first_of("0123456789") != std::string::npos;
  };
  if (names.size() > 1 && !std::all_of(names.begin(), names.end(), has_number))
    images.doubt = "no number in the names of some";
  return images;
}

// A list of pictures: a path on each line, relative to the list's folder.
NumberedImages in_list(const fs::path& list) {
  NumberedImages result;
  const std::string text = read_file(list, kMaxListBytes);
  int number = 0;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::string_view line = trimmed(std::string_view(text).substr(at, end - at));
    at = end + 1;
    ++number;
    if (line.empty() || line.front() == '#') continue;
    const fs::path file = list.parent_path() / line;
    const Where where{list.string(), number};
    if (!picture_series::is_picture_file(file))
      throw Error(fmt::format("is '{}'; expected the path of a picture, since a text file is read "
                              "as a list of a clip's pictures",
                              line.substr(0, 200)),
                  where);
    std::error_code ignored;
    if (!fs::is_regular_file(file, ignored))
      throw Error(fmt::format("names {}, which does not exist", file.string()), where);
    result.files.push_back(file);
  }
  if (result.files.empty()) throw Error("names no picture", {list.string()});
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
  std::vector<fs::path> images;
  std::error_code ignored;
  if (fs::is_directory(folder, ignored))
    for (const auto& entry : fs::directory_iterator(folder)) {
      const std::string file = entry.path().filename().string();
      if (file.size() <= before.size() + after.size() || !file.starts_with(before) ||
          !file.ends_with(after))
        continue;
      const std::string digits = file.substr(begin, file.size() - before.size() - after.size());
      if (std::all_of(digits.begin(), digits.end(), is_digit)) images.push_back(entry.path());
    }
  if (images.empty()) throw Error("matches no file; expected numbered images", {path.string()});
  std::sort(images.begin(), images.end(), [](const fs::path& a, const fs::path& b) {
    return picture_series::is_numbered_before(a.filename().string(), b.filename().string());
  });
  return in_order(std::move(images));
}

}  // namespace

std::optional<NumberedImages> numbered_images(const fs::path& path) {
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) return in_folder(path);
  if (path.extension() == ".txt" && fs::exists(path, ignored)) return in_list(path);
  if (fs::exists(path, ignored)) return std::nullopt;
  const auto number = number_in_pattern(path.filename().string());
  if (!number) return std::nullopt;
  return of_pattern(path, number->first, number->second);
}

std::string clip_name(const fs::path& video) {
  fs::path named = absolute_path(video);
  std::error_code ignored;
  if (number_in_pattern(named.filename().string()) && !fs::exists(named, ignored))
    named = named.parent_path();
  const std::string name = named.stem().string();
  return name.empty() ? "video" : name;
}

}  // namespace airtruth::video
