// SPDX-License-Identifier: Apache-2.0
#include "labels/exchange/parts.h"

#include <algorithm>
#include <set>

#include <fmt/format.h>

#include "foundation/base/error.h"

namespace airtruth::exchange {

std::vector<fs::path> FolderWriter::images(const Clip& clip, const std::string& part) const {
  std::vector<fs::path> files;
  for (std::size_t i = 0; i < clip.frames.size(); ++i) files.push_back(image(clip, part, i));
  return files;
}

std::size_t FolderWriter::class_of(const std::string& category) const {
  const auto& all = options_.categories;
  return static_cast<std::size_t>(std::ranges::find(all, category) - all.begin());
}

std::string numbered_stem(const Clip& clip, std::size_t i) {
  return fmt::format("{}_{:06}", clip.name, i);
}

void Reading::fill(std::size_t more, const std::string& name) const {
  filled += more;
  if (filled > kMostFilled)
    throw Error(fmt::format("states more than {} frames and boxes up to those of '{}', most of "
                            "them by a number alone; expected fewer at once",
                            kMostFilled,
                            name),
                {source.string()});
}

LabelledFrame& frame_at(Clip& clip, std::size_t number, const Reading& in) {
  if (number >= clip.frames.size()) in.fill(number + 1 - clip.frames.size(), clip.name);
  for (std::size_t i = clip.frames.size(); i <= number; ++i)
    clip.frames.push_back({static_cast<std::int64_t>(i), std::nullopt, {}});
  return clip.frames[number];
}

bool number_tracks(std::vector<Label>& labels) {
  std::set<std::int64_t> taken;
  for (const Label& label : labels) taken.insert(label.track);
  std::int64_t next = 1;
  for (Label& label : labels) {
    if (label.track >= 0) continue;
    while (taken.contains(next)) ++next;
    label.track = next++;
  }
  return !taken.empty() && *taken.begin() < 0;
}

std::vector<fs::path> files_of(const fs::path& source,
                               std::vector<fs::path> found,
                               const std::string& what) {
  if (!fs::is_directory(source)) return {source};
  if (found.empty()) throw Error("holds no " + what, {source.string()});
  return found;
}

void append(Clips& clips, Clips more) {
  std::move(more.begin(), more.end(), std::back_inserter(clips));
}

std::vector<fs::path> two_levels(const fs::path& folder) {
  std::vector<fs::path> found = {folder};
  for (const fs::path& outer : entries(folder)) {
    found.push_back(outer);
    for (const fs::path& inner : entries(outer)) found.push_back(inner);
  }
  return found;
}

}  // namespace airtruth::exchange
