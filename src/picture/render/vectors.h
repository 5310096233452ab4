// SPDX-License-Identifier: Apache-2.0
#pragma once

// The compiler emits functions that are marked so with vectors of 16, 8 or 4 numbers, as the
// machine supports them. No product is fused with its sum (-ffp-contract=off), so all variants give
// the same bits.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__)
#define AIRTRUTH_VECTORS __attribute__((target_clones("arch=x86-64-v4", "avx2", "default")))
#else
#define AIRTRUTH_VECTORS
#endif
