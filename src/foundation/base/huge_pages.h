// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include <sys/mman.h>

namespace airtruth {

// Asks the kernel to supply the memory of [begin, begin + bytes) in pages of 2 MiB as far as whole
// ones lie within it (madvise(2), MADV_HUGEPAGE), at its first use: one page fault in place of 512.
// Where the kernel has none to give, nothing changes.
inline void ask_for_huge_pages(void* begin, std::size_t bytes) {
  constexpr std::uintptr_t kPage = 2 << 20;
  const auto from = (reinterpret_cast<std::uintptr_t>(begin) + kPage - 1) / kPage * kPage;
  const auto to = (reinterpret_cast<std::uintptr_t>(begin) + bytes) / kPage * kPage;
  if (from < to) ::madvise(reinterpret_cast<void*>(from), to - from, MADV_HUGEPAGE);
}

}  // namespace airtruth
