// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "foundation/base/error.h"
#include "runners/results/results_folder.h"

namespace airtruth::results {

struct SetImage {
  std::size_t sequence = 0;  // index in the set
  std::int64_t frame = 0;
};

// The images of a set by their number and by their name (ExpectedSequence states both).
class SetImages {
 public:
  // `set` must outlive the object.
  explicit SetImages(std::span<const ExpectedSequence> set);
  // Both throw Error at `where` for an image that the set does not have.
  SetImage by_id(std::int64_t id, const Where& where) const;
  // "images/all/NAME/000012.jpg" and "NAME/000012" alike.
  SetImage by_name(const std::string& text, const Where& where) const;

 private:
  std::span<const ExpectedSequence> set_;
  std::vector<std::int64_t> first_ids_;
  std::int64_t end_ = 1;
  std::map<std::string, std::size_t> names_;
};

}  // namespace airtruth::results
