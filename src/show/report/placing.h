// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "foundation/geometry/box.h"

// Where labels go on a picture so that none overprints another.
namespace airtruth::report {

struct Placing {
  PixelBox frame;               // no label leaves it
  std::vector<PixelBox> taken;  // by other labels: never overprinted
  std::vector<PixelBox> boxes;  // overprinted only where nothing else is left
};

// The place of a label of `width` by `height` pixels for the box `anchor`: the first of the eight
// places around it, then of rings that grow by a label's height, that overprints nothing; else the
// one that overprints the fewest pixels of `boxes`. nullopt where every place meets a label or the
// frame's edge.
std::optional<PixelBox> place_label(const PixelBox& anchor,
                                    int width,
                                    int height,
                                    const Placing& placing);

}  // namespace airtruth::report
