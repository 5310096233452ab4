// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace airtruth {

// Asks the kernel to supply the memory of [begin, begin + bytes) in pages of 2 MiB as far as whole
// ones lie within it (madvise(2), MADV_HUGEPAGE), at its first use: one page fault in place of 512.
// Where the kernel has none to give, nothing changes.
void ask_for_huge_pages(void* begin, std::size_t bytes);

}  // namespace airtruth
