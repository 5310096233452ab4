// SPDX-License-Identifier: Apache-2.0
#include "dataset/stream/places.h"

namespace airtruth::stream {

Place place_of(std::int64_t index, std::int64_t reuse) {
  const std::int64_t samples_of_run = kRunFrames * reuse;
  const std::int64_t turn = index / kLanes;  // of the lanes
  const std::int64_t lane = index % kLanes;
  return {
      turn / samples_of_run * kLanes + lane, turn % samples_of_run / reuse, turn % samples_of_run};
}

}  // namespace airtruth::stream
