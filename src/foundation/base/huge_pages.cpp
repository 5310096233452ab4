// SPDX-License-Identifier: Apache-2.0
#include "foundation/base/huge_pages.h"

#include <cstdint>

#include <sys/mman.h>

namespace airtruth {

void ask_for_huge_pages(void* begin, std::size_t bytes) {
  constexpr std::uintptr_t kPage = 2 << 20;
  const auto from = (reinterpret_cast<std::uintptr_t>(begin) + kPage - 1) / kPage * kPage;
  const auto to = (reinterpret_cast<std::uintptr_t>(begin) + bytes) / kPage * kPage;
  if (from < to) ::madvise(reinterpret_cast<void*>(from), to - from, MADV_HUGEPAGE);
}

}  // namespace airtruth
