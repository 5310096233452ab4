// SPDX-License-Identifier: Apache-2.0
#include "evaluation/report/film.h"

#include <fmt/format.h>

namespace airtruth::report {

void add_stills(std::vector<html::PagePicture>& pictures,
                std::size_t sequence,
                const std::vector<drawing::Still>& stills) {
  for (std::size_t i = 0; i < stills.size(); ++i) {
    pictures.push_back({fmt::format("whole-{}-{}", sequence, i), stills[i].whole});
    pictures.push_back({fmt::format("close-{}-{}", sequence, i), stills[i].close.jpeg});
  }
}

}  // namespace airtruth::report
