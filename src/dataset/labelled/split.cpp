// SPDX-License-Identifier: Apache-2.0
#include "dataset/labelled/split.h"

#include <algorithm>
#include <set>

#include <fmt/format.h>

#include "foundation/base/error.h"
#include "foundation/base/files.h"

namespace airtruth::labelled {
namespace {

constexpr std::array<const char*, 3> kParts = {"train", "val", "test"};

struct Group {
  // A random key, so that the order of equally large groups does not follow their names.
  std::string order;
  std::vector<std::string> sequences;
  std::int64_t frames = 0;
};

std::vector<Group> groups_of(const std::vector<ClipFacts>& clips, Split split, std::uint64_t seed) {
  std::map<std::string, Group> groups;
  for (const ClipFacts& clip : clips) {
    Group& group = groups[split == Split::kByBackground ? clip.background : clip.name];
    group.sequences.push_back(clip.name);
    group.frames += clip.frames;
  }
  std::vector<Group> result;
  for (auto& [name, group] : groups) {
    group.order = sha256_of(std::to_string(seed) + "/" + fs::path(name).filename().string());
    result.push_back(std::move(group));
  }
  std::sort(result.begin(), result.end(), [](const Group& a, const Group& b) {
    return a.frames != b.frames ? a.frames > b.frames : a.order < b.order;
  });
  return result;
}

// Frames and groups that the parts have so far.
struct Filled {
  std::array<double, 3> frames{};
  std::array<std::size_t, 3> groups{};
};

// The part that takes the next group: the one that lacks most of its share. While as many groups
// are left as parts are empty, an empty one.
std::size_t next_part(const Filled& filled,
                      const std::array<double, 3>& shares,
                      double total_frames,
                      std::size_t groups_left) {
  std::size_t empty = 0;
  for (std::size_t p = 0; p < 3; ++p) empty += shares[p] > 0 && filled.groups[p] == 0 ? 1 : 0;
  std::size_t best = 3;
  for (std::size_t p = 0; p < 3; ++p) {
    if (shares[p] <= 0 || (groups_left <= empty && filled.groups[p] > 0)) continue;
    const auto deficit = [&](std::size_t q) { return shares[q] * total_frames - filled.frames[q]; };
    if (best == 3 || deficit(p) > deficit(best)) best = p;
  }
  check(best < 3, "some part has a share");
  return best;
}

void warn_of_shared_backgrounds(const std::vector<ClipFacts>& clips,
                                const std::map<std::string, std::string>& parts,
                                const Warn& warn) {
  std::map<std::string, std::set<std::string>> parts_of_background;
  for (const ClipFacts& clip : clips)
    parts_of_background[clip.background].insert(parts.at(clip.name));
  const auto shared = std::ranges::count_if(
      parts_of_background, [](const auto& entry) { return entry.second.size() > 1; });
  if (shared > 0)
    airtruth::warn(
        warn,
        fmt::format("{} of {} backgrounds are in more than one part: a model that is trained on "
                    "one part may know the background of the other",
                    shared,
                    parts_of_background.size()));
}

}  // namespace

std::map<std::string, std::string> parted(const std::vector<ClipFacts>& clips,
                                          Split split,
                                          const std::array<double, 3>& shares,
                                          std::uint64_t seed,
                                          const Warn& warn) {
  std::map<std::string, std::string> parts;
  if (split == Split::kNone) {
    for (const ClipFacts& clip : clips) parts[clip.name] = "all";
    return parts;
  }
  const std::vector<Group> groups = groups_of(clips, split, seed);
  double total = 0;
  for (const Group& group : groups) total += static_cast<double>(group.frames);
  Filled filled;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const std::size_t part = next_part(filled, shares, total, groups.size() - g);
    for (const std::string& name : groups[g].sequences) parts[name] = kParts[part];
    filled.frames[part] += static_cast<double>(groups[g].frames);
    ++filled.groups[part];
  }
  for (std::size_t p = 0; p < 3; ++p)
    if (shares[p] > 0 && filled.groups[p] == 0)
      airtruth::warn(warn,
                     fmt::format("{} stays empty: there are only {} {}",
                                 kParts[p],
                                 groups.size(),
                                 split == Split::kByBackground ? "backgrounds" : "sequences"));
  warn_of_shared_backgrounds(clips, parts, warn);
  return parts;
}

}  // namespace airtruth::labelled
