// SPDX-License-Identifier: Apache-2.0
#include "show/plot/plot.h"

#include <cmath>

#include <fmt/format.h>

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

std::string name_of_bin(double from, double to) {
  if (!std::isfinite(to)) return fmt::format("≥ {}", from);
  if (!std::isfinite(from)) return fmt::format("< {}", to);
  // A dash beside a minus sign is hard to read.
  return fmt::format(fmt::runtime(from < 0 ? "{} to {}" : "{}–{}"), from, to);
}

}  // namespace airtruth::plot
