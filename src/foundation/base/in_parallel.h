// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <stop_token>

namespace airtruth {

// Calls each(0) .. each(count - 1) on `jobs` threads (0: one per core). The first failure lets the
// others end what they are at, and is thrown again; Interrupted after a stop. `progress` is told of
// every call that is over, one at a time.
void in_parallel(std::size_t count,
                 int jobs,
                 const std::function<void(std::size_t)>& each,
                 const std::function<void(std::int64_t done, std::int64_t total)>& progress,
                 const std::stop_token& stop);

}  // namespace airtruth
