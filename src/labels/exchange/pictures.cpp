// SPDX-License-Identifier: Apache-2.0
#include "labels/exchange/pictures.h"

#include <algorithm>
#include <functional>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "foundation/base/error.h"
#include "labels/exchange/text.h"

namespace airtruth::exchange {
namespace {

std::vector<std::string> names_of(std::span<const LabelledPicture> pictures) {
  std::vector<std::string> names;
  for (const LabelledPicture& picture : pictures) names.push_back(picture.name);
  return names;
}

void sort_pictures(std::vector<LabelledPicture>& pictures) {
  const bool have_numbers = std::ranges::all_of(
      pictures, [](const LabelledPicture& picture) { return picture.number.has_value(); });
  std::ranges::stable_sort(pictures, [&](const LabelledPicture& a, const LabelledPicture& b) {
    return have_numbers ? *a.number < *b.number
                        : picture_series::is_numbered_before(a.name, b.name);
  });
}

// The numbers of ordered pictures as frames: stated, in the names, or their places. Those that
// begin with 1, as ffmpeg and MOTChallenge number, count from it.
std::vector<std::int64_t> frame_numbers(std::span<const LabelledPicture> pictures) {
  const auto ascend = [](const std::vector<std::int64_t>& numbers) {
    return std::ranges::adjacent_find(numbers, std::greater_equal<>()) == numbers.end();
  };
  std::vector<std::int64_t> stated, named, places;
  for (const LabelledPicture& picture : pictures) {
    places.push_back(std::ssize(places));
    if (picture.number) stated.push_back(*picture.number);
    if (const auto number = name_and_number(fs::path(picture.name).stem().string()).second)
      named.push_back(*number);
  }
  for (std::vector<std::int64_t>& numbers : {std::ref(stated), std::ref(named)}) {
    if (numbers.size() != pictures.size() || !ascend(numbers)) continue;
    if (numbers.front() == 1)
      for (std::int64_t& number : numbers) --number;
    return numbers;
  }
  return places;
}

// The folder of all pictures; empty, with a warning where some are there, if one is missing.
fs::path media_of(std::span<const LabelledPicture> pictures,
                  const std::string& clip,
                  const fs::path& source,
                  const Warn& warn) {
  const auto is_missing = [](const LabelledPicture& picture) { return picture.folder.empty(); };
  const auto missing = std::ranges::count_if(pictures, is_missing);
  if (missing == 0) return pictures.front().folder;
  if (missing < std::ssize(pictures))
    airtruth::warn(warn,
                   fmt::format("{}: {} of the {} pictures of {} are not there (the first: {}); it "
                               "is imported without pictures",
                               source.string(),
                               missing,
                               pictures.size(),
                               clip,
                               std::ranges::find_if(pictures, is_missing)->name));
  return {};
}

std::string first_of(const std::string& a, const std::string& b, const std::string& c) {
  return !a.empty() ? a : !b.empty() ? b : c;
}

}  // namespace

void expect_inside(const std::string& name, const Where& where) {
  const fs::path path(name);
  if (path.is_absolute() || std::find(path.begin(), path.end(), "..") != path.end())
    throw Error("names the picture '" + name +
                    "', which leads out of the set's folder; expected a name below it",
                where);
}

fs::path folder_of_picture(std::span<const fs::path> folders,
                           const std::string& name,
                           const Where& where) {
  expect_inside(name, where);
  std::error_code ignored;
  for (const fs::path& folder : folders)
    if (fs::is_regular_file(folder / name, ignored)) return folder;
  return {};
}

Clip clip_of_pictures(const std::string& name,
                      std::vector<LabelledPicture> pictures,
                      const fs::path& source,
                      const Warn& warn) {
  Clip clip;
  clip.name = name;
  if (pictures.empty()) return clip;
  std::set<std::string> names;
  for (const LabelledPicture& picture : pictures)
    if (!names.insert(picture.name).second)
      throw Error("names the picture '" + picture.name + "' twice", {source.string()});
  sort_pictures(pictures);
  const auto size_of = [](const LabelledPicture& picture) {
    return std::pair(picture.width, picture.height);
  };
  if (std::ranges::adjacent_find(pictures, std::not_equal_to<>(), size_of) == pictures.end()) {
    std::tie(clip.width, clip.height) = size_of(pictures.front());
    clip.media = media_of(pictures, name, source, warn);
  } else {
    airtruth::warn(warn,
                   source.string() + ": the pictures of " + name +
                       " differ in size, as those of no video do; they are imported without size "
                       "and pictures");
  }
  const std::vector<std::int64_t> numbers = frame_numbers(pictures);
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    LabelledPicture& picture = pictures[i];
    clip.frames.push_back(
        {numbers[i], picture.time_s, std::move(picture.labels), picture.name, picture.image_id});
  }
  return clip;
}

std::vector<Clip> clips_of_pictures(std::vector<LabelledPicture> pictures,
                                    const std::string& otherwise,
                                    const fs::path& source,
                                    const Warn& warn) {
  std::map<std::pair<fs::path, std::string>, std::vector<LabelledPicture>> folders;
  for (LabelledPicture& picture : pictures) {
    const std::string folder = fs::path(picture.name).parent_path().string();
    folders[{picture.folder, folder}].push_back(std::move(picture));
  }
  std::vector<Clip> clips;
  for (auto& [key, held] : folders) {
    const std::vector<std::string> names = names_of(held);
    const std::vector<picture_series::Series> all =
        picture_series::series_of(names, picture_series::Stray::kOfOneSeries);
    for (const picture_series::Series& series : all) {
      std::vector<LabelledPicture> one;
      for (const std::size_t i : series) one.push_back(std::move(held[i]));
      const std::string common = picture_series::common_name(names_of(one));
      std::string folder = key.second;
      std::ranges::replace(folder, '/', '-');
      const std::string name = all.size() > 1 ? first_of(common, folder, otherwise)
                                              : first_of(folder, otherwise, common);
      clips.push_back(clip_of_pictures(first_of(name, "images", ""), std::move(one), source, warn));
    }
  }
  return clips;
}

void join_by_name(Clip& clip, const fs::path& folder, const Warn& warn) {
  const auto missing = std::ranges::find_if(clip.frames, [&](const LabelledFrame& frame) {
    return frame.picture.empty() || !fs::is_regular_file(folder / frame.picture);
  });
  if (missing == clip.frames.end())
    clip.media = folder;
  else
    airtruth::warn(
        warn,
        fmt::format("{}: holds no picture of frame {} of {}; it is imported without pictures",
                    folder.string(),
                    missing->frame,
                    clip.name));
}

void join_by_number(Clip& clip,
                    const fs::path& folder,
                    std::int64_t first_number,
                    const Warn& warn) {
  std::map<std::int64_t, std::vector<std::string>> by_number;
  for (const std::string& name : pictures_in(folder))
    if (const auto number = name_and_number(fs::path(name).stem().string()).second)
      by_number[*number].push_back(name);
  std::vector<std::string> names;
  for (const LabelledFrame& labelled : clip.frames) {
    const std::int64_t number = first_number + labelled.frame;
    const auto found = by_number.find(number);
    const std::size_t count = found == by_number.end() ? 0 : found->second.size();
    if (count != 1)
      return airtruth::warn(warn,
                            fmt::format("{}: holds {} pictures with the number {}, of which a "
                                        "frame of {} is labelled; it is imported without pictures",
                                        folder.string(),
                                        count == 0 ? "no" : fmt::format("{}", count),
                                        number,
                                        clip.name));
    names.push_back(found->second.front());
  }
  clip.media = folder;
  for (std::size_t i = 0; i < names.size(); ++i) clip.frames[i].picture = names[i];
}

void join_in_order(Clip& clip, const fs::path& folder, const Warn& warn) {
  std::vector<std::string> names = pictures_in(folder);
  if (names.empty()) return;
  std::ranges::stable_sort(names, picture_series::is_numbered_before);
  const std::size_t series = picture_series::series_of(names, picture_series::Stray::kApart).size();
  if (names.size() != clip.frames.size() || series != 1)
    return airtruth::warn(warn,
                          fmt::format("{}: holds {} pictures{}, and there are labels for {} frames "
                                      "of {}; it is imported without pictures",
                                      folder.string(),
                                      names.size(),
                                      series == 1 ? "" : fmt::format(" of {} series", series),
                                      clip.frames.size(),
                                      clip.name));
  clip.media = folder;
  for (std::size_t i = 0; i < names.size(); ++i) clip.frames[i].picture = names[i];
}

}  // namespace airtruth::exchange
