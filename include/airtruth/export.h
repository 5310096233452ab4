// SPDX-License-Identifier: Apache-2.0
#pragma once

// Marks what libairtruth.so and libairtruth-evaluation.so export. Everything else in them is
// compiled with -fvisibility=hidden.
#define AIRTRUTH_API __attribute__((visibility("default")))
