// SPDX-License-Identifier: Apache-2.0
#include "show/plot/plot.h"

namespace airtruth::plot {

Style style_of(std::size_t index) {
  // Number of the colours that everyone can distinguish (kColours).
  constexpr std::size_t kColoursOfOneDash = 6;
  const std::size_t dash = index / kColoursOfOneDash;
  return {kColours[index % kColours.size()],
          dash == 0   ? Dash::kSolid
          : dash == 1 ? Dash::kLong
                      : Dash::kShort};
}

}  // namespace airtruth::plot
