// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "dataset/labelled/labelled_set.h"
#include "foundation/base/log.h"

namespace airtruth::dataset {

// How a data set is parted into train, val and test.
enum class Split {
  kNone,          // one part, "all"
  kByBackground,  // all the sequences over one video go to one part
  kBySequence,    // the same video may be in several parts
};
Split split_from_name(std::string_view name);  // "none", "by-background", "by-sequence"

// The part of each sequence, by name. Sequences are kept together as asked, and given out so that
// the parts' shares of the frames come near to `shares` (of train, val, test); a part with a share
// is not left empty while there are groups enough. The same for the same seed. Warns where parts
// stay empty, and where a background is in more than one.
std::map<std::string, std::string> parted(const std::vector<ClipFacts>& clips,
                                          Split split,
                                          const std::array<double, 3>& shares,
                                          std::uint64_t seed,
                                          const Warn& warn);

}  // namespace airtruth::dataset
