// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace airtruth::image {

// Copies every `step`-th of the source's bytes: one component of packed pixels.
void take_every(const std::uint8_t* source, int step, int count, std::uint8_t* target);

// 255 where (red + 2 green + blue) / 4 is at least `least`, else 0.
void mark_light(const std::uint8_t* red,
                const std::uint8_t* green,
                const std::uint8_t* blue,
                int least,
                int count,
                std::uint8_t* target);

}  // namespace airtruth::image
