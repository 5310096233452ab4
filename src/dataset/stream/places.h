// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

// The order in which a stream goes through its backgrounds.
//
// Eight runs of consecutive frames, the lanes, take turns. A lane makes `reuse` samples of one
// frame before it goes on to the next, and begins another run, of another background or place,
// after kRunFrames frames. So samples in a row are of eight places, and each decoded frame is used
// often. What is put there is drawn for each sample by itself.
//
// Example: reuse = 8. Samples 0, 8, .., 56 are of the first frame of run 0, samples 1, 9, .., 57 of
// the first frame of run 1; sample 64 is of the second frame of run 0.
namespace airtruth::stream {

inline constexpr std::int64_t kLanes = 8;  // chosen
// Chosen: the frames between a key frame and a run's first frame are decoded in vain, some 125 of
// the usual 250 between key frames.
inline constexpr std::int64_t kRunFrames = 16;

struct Place {
  std::int64_t run = 0;
  // Of the run's frames, 0 to kRunFrames - 1.
  std::int64_t step = 0;
  // Of the samples of the same run, which count on through all its frames.
  std::int64_t sample_of_run = 0;
};

Place place_of(std::int64_t index, std::int64_t reuse);

}  // namespace airtruth::stream
