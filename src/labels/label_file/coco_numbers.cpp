// SPDX-License-Identifier: Apache-2.0
#include "labels/label_file/coco_numbers.h"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

namespace airtruth::label_file {

void CocoNumbers::add(std::int64_t frames,
                      const std::vector<std::string>& pictures,
                      const std::vector<std::optional<std::int64_t>>& image_ids,
                      const std::map<std::int64_t, std::string>& category_ids) {
  first_ids_.push_back(frames_ + 1);
  frames_ += frames;
  std::set<std::string> stems;
  for (const std::string& picture : pictures)
    if (!picture.empty()) stems.insert(std::filesystem::path(picture).stem().string());
  are_named_ = are_named_ && std::ssize(stems) == frames;
  are_numbered_ = are_numbered_ && std::ssize(image_ids) == frames &&
                  std::ranges::all_of(image_ids, [&](const auto& id) {
                    return id && image_ids_.insert(*id).second;
                  });
  have_categories_ = have_categories_ && !category_ids.empty();
  for (const auto& [id, name] : category_ids)
    if (categories_.emplace(id, name).first->second != name) have_categories_ = false;
}

void CocoNumbers::add(const exchange::Clip& clip) {
  std::vector<std::string> pictures;
  std::vector<std::optional<std::int64_t>> image_ids;
  for (const exchange::LabelledFrame& frame : clip.frames) {
    pictures.push_back(frame.picture);
    image_ids.push_back(frame.image_id);
  }
  add(std::ssize(clip.frames), pictures, image_ids, clip.category_ids);
}

std::pair<std::size_t, std::int64_t> CocoNumbers::counted(std::int64_t id) const {
  const auto first = std::ranges::upper_bound(first_ids_, id) - 1;
  return {static_cast<std::size_t>(first - first_ids_.begin()), id - *first};
}

std::int64_t CocoNumbers::image_id(std::size_t clip,
                                   std::size_t frame,
                                   const std::optional<std::int64_t>& stated) const {
  if (are_numbered_ && stated) return *stated;
  return first_ids_[clip] + static_cast<std::int64_t>(frame);
}

void CocoNumbers::number(exchange::Clip& clip, std::size_t at) const {
  for (std::size_t i = 0; i < clip.frames.size(); ++i) {
    exchange::LabelledFrame& frame = clip.frames[i];
    frame.image_id = image_id(at, i, frame.image_id);
    if (!are_named_) frame.picture = fmt::format("{:06}", i);
  }
}

std::map<std::string, std::int64_t> CocoNumbers::category_ids(
    const std::set<std::string>& names, const std::set<std::string>& aircraft) const {
  std::map<std::string, std::int64_t> ids;
  std::int64_t next = 1;
  if (have_categories_ && !categories_.empty()) {
    next = std::max<std::int64_t>(next, categories_.rbegin()->first + 1);
    for (const auto& [id, name] : categories_) ids.try_emplace(name, id);
    for (const auto& [id, name] : categories_)
      if (aircraft.contains(name)) ids.try_emplace("aircraft", id);
  }
  for (const std::string& name : names)
    if (ids.try_emplace(name, next).second) ++next;
  return ids;
}

}  // namespace airtruth::label_file
