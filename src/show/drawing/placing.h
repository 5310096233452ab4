// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "foundation/geometry/box.h"

// Places labels on a picture without overlaps between them.
namespace airtruth::drawing {

struct Placing {
  // No label leaves it.
  PixelBox frame;
  // Places of other labels; no label overlaps them.
  std::vector<PixelBox> taken;
  // Boxes; a label overlaps them only where nothing else is left.
  std::vector<PixelBox> boxes;
};

// The place of a label of `width` by `height` pixels for the box `anchor`. The candidates are the
// eight places around the box, then rings of places at distances that grow by a label's height. The
// first one without an overlap is chosen, else the one that overlaps the fewest pixels of `boxes`.
// nullopt where every candidate overlaps a label or leaves the frame.
std::optional<PixelBox> place_label(const PixelBox& anchor,
                                    int width,
                                    int height,
                                    const Placing& placing);

}  // namespace airtruth::drawing
