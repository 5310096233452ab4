// SPDX-License-Identifier: Apache-2.0
#include "scene/synthetic/mip_map.h"

#include <algorithm>

namespace airtruth::synthetic {

MipMap MipMap::with_size(int size) {
  MipMap map;
  map.size = size;
  std::int32_t total = 0;
  for (int side = size; side >= 2; side /= 2) {
    const auto level = static_cast<std::size_t>(map.levels++);
    map.first[level] = total;
    map.wrap[level] = side - 1;
    map.scale[level] = static_cast<float>(side) / static_cast<float>(size);
    total += std::max(side * side, 16);
  }
  map.texels.resize(static_cast<std::size_t>(total));
  return map;
}

}  // namespace airtruth::synthetic
