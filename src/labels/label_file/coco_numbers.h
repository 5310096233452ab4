// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <airtruth/labels.h>

// What COCO files call the pictures and categories of a set: the export writes it, and results that
// are read and written by it fit the export.
namespace airtruth::label_file {

// The numbers and names that the set's source states where all of the set have one and none is
// there twice; else those that are counted over the whole set.
//
// Example: a set of two clips of two frames, of which nothing is stated. The second clip's pictures
// have the numbers 3 and 4 and the names 000000 and 000001.
class CocoNumbers {
 public:
  // The set's next clip, with all its frames: how many, and what its source states of each, as
  // LabelledFrame has it (both lists may be empty), and of its categories.
  void add(std::int64_t frames,
           const std::vector<std::string>& pictures,
           const std::vector<std::optional<std::int64_t>>& image_ids,
           const std::map<std::int64_t, std::string>& category_ids);
  void add(const exchange::Clip& clip);

  // The rest needs all clips. `clip` is the place of a clip in the set, from 0.
  bool states_image_ids() const { return are_numbered_; }
  bool states_names() const { return are_named_; }
  std::int64_t frames() const { return frames_; }
  // The clip and the frame in it that have a number where they are counted, which is 1 to frames().
  std::pair<std::size_t, std::int64_t> counted(std::int64_t id) const;
  // `stated` is what the source states of that frame.
  std::int64_t image_id(std::size_t clip,
                        std::size_t frame,
                        const std::optional<std::int64_t>& stated) const;
  // Sets the number and the name (LabelledFrame::picture) of each frame of a clip that is whole.
  void number(exchange::Clip& clip, std::size_t at) const;
  // By name. Where the source states no "aircraft", this is the first of its `aircraft`; what it
  // does not state follows in alphabetical order.
  std::map<std::string, std::int64_t> category_ids(const std::set<std::string>& names,
                                                   const std::set<std::string>& aircraft) const;

 private:
  std::int64_t frames_ = 0;
  std::vector<std::int64_t> first_ids_;  // where they are counted
  std::set<std::int64_t> image_ids_;
  bool are_numbered_ = true;
  bool are_named_ = true;
  std::map<std::int64_t, std::string> categories_;
  bool have_categories_ = true;
};

}  // namespace airtruth::label_file
