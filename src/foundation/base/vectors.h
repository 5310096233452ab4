// SPDX-License-Identifier: Apache-2.0
#pragma once

// A function with AIRTRUTH_FOR_VECTORS is compiled for vectors of 16, 8 and 4 floats, and the
// machine's widest is called. One with AIRTRUTH_FOR_SHORT_VECTORS is compiled for 8 and 4: its
// loops run over some tens of numbers, in which vectors of 16 cost more than they save
// (docs/optimisations.md). No product is fused with its sum (-ffp-contract=off) and no sum is
// reordered, so all variants give the same bits.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__)
#define AIRTRUTH_FOR_VECTORS __attribute__((target_clones("arch=x86-64-v4", "avx2", "default")))
#define AIRTRUTH_FOR_SHORT_VECTORS __attribute__((target_clones("avx2", "default")))
#else
#define AIRTRUTH_FOR_VECTORS
#define AIRTRUTH_FOR_SHORT_VECTORS
#endif
