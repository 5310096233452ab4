// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "dataset/labelled/labelled_set.h"
#include "foundation/base/log.h"
#include "foundation/base/names.h"

namespace airtruth::labelled {

// How a data set is divided into train, val and test.
enum class Split {
  kNone,          // one part, "all"
  kByBackground,  // all the sequences over one video go to one part
  kBySequence,    // the same video may be in several parts
};

constexpr auto enum_names(Split) {
  return std::to_array<EnumName<Split>>({{Split::kNone, "none"},
                                         {Split::kByBackground, "by-background"},
                                         {Split::kBySequence, "by-sequence"}});
}

// Returns the part of each sequence, by the sequence's name. Sequences stay together as `split`
// says. The groups are assigned so that the parts' shares of the frames come near to `shares`
// (train, val, test). A part with a share above 0 receives at least one group as long as there are
// enough groups. The same seed gives the same result. Warns where a part stays empty, and where a
// background is in more than one part.
std::map<std::string, std::string> parted(const std::vector<ClipFacts>& clips,
                                          Split split,
                                          const std::array<double, 3>& shares,
                                          std::uint64_t seed,
                                          const Warn& warn);

}  // namespace airtruth::labelled
