// SPDX-License-Identifier: Apache-2.0
#pragma once

// A function with this mark is compiled for vectors of 16, 8 and 4 floats, and the machine's widest
// is called. No product is fused with its sum (-ffp-contract=off) and no sum is reordered, so all
// variants give the same bits.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__)
#define AIRTRUTH_FOR_VECTORS __attribute__((target_clones("arch=x86-64-v4", "avx2", "default")))
#else
#define AIRTRUTH_FOR_VECTORS
#endif
