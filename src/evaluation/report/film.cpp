// SPDX-License-Identifier: Apache-2.0
#include "evaluation/report/film.h"

#include <fmt/format.h>

#include "foundation/base/error.h"

namespace airtruth::report {

const image::Picture& ClipPictures::at(std::int64_t frame) {
  if (stop_.stop_requested()) throw Interrupted();
  const image::Picture* picture = frames_.at(frame);
  if (picture == nullptr)
    throw Error("ends before the labels of " + name_ + " do", {media_.string()});
  return *picture;
}

void add_stills(std::vector<html::PagePicture>& pictures,
                std::size_t sequence,
                const std::vector<drawing::Still>& stills) {
  for (std::size_t i = 0; i < stills.size(); ++i) {
    pictures.push_back({fmt::format("whole-{}-{}", sequence, i), stills[i].whole});
    pictures.push_back({fmt::format("close-{}-{}", sequence, i), stills[i].close.jpeg});
  }
}

}  // namespace airtruth::report
