// SPDX-License-Identifier: Apache-2.0
#include "runners/results/set_images.h"

#include <algorithm>
#include <charconv>

#include <fmt/format.h>

#include "foundation/base/suggest.h"

namespace airtruth::results {

SetImages::SetImages(std::span<const ExpectedSequence> set) : set_(set) {
  std::int64_t first = 1;
  for (std::size_t i = 0; i < set.size(); ++i) {
    first_ids_.push_back(first);
    first += set[i].frames;
    names_.emplace(set[i].name, i);
  }
  end_ = first;
}

SetImage SetImages::by_id(std::int64_t id, const Where& where) const {
  if (id < 1 || id >= end_)
    throw Error(fmt::format("image_id is {}; the set has the images 1 to {}", id, end_ - 1), where);
  const auto after = std::upper_bound(first_ids_.begin(), first_ids_.end(), id);
  const auto i = static_cast<std::size_t>(after - first_ids_.begin()) - 1;
  return {i, id - first_ids_[i]};
}

SetImage SetImages::by_name(const std::string& text, const Where& where) const {
  fs::path path(text);
  const std::string stem = path.stem().string();
  std::int64_t frame = -1;
  const auto [end, failed] = std::from_chars(stem.data(), stem.data() + stem.size(), frame);
  const std::string name = path.parent_path().filename().string();
  const auto found = names_.find(name);
  const bool is_number = failed == std::errc() && end == stem.data() + stem.size() && frame >= 0;
  if (found != names_.end() && is_number && frame < set_[found->second].frames)
    return {found->second, frame};
  std::string hint;
  if (found != names_.end()) {
    hint = fmt::format("; '{}' has the frames 0 to {}", name, set_[found->second].frames - 1);
  } else {
    std::vector<std::string> names;
    for (const ExpectedSequence& sequence : set_) names.push_back(sequence.name);
    if (const auto near = nearest_spelling(name, names))
      hint = "; did you mean the sequence '" + *near + "'?";
  }
  throw Error("the set has no image '" + text.substr(0, 200) +
                  "'; expected SEQUENCE/NUMBER.jpg, with frames from 0" + hint,
              where);
}

}  // namespace airtruth::results
