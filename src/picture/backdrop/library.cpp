// SPDX-License-Identifier: Apache-2.0
// The library itself, airtruth-late-backdrop.so.
#include "picture/backdrop/backdrop.h"

extern "C" {
extern __attribute__((visibility("default")))
const airtruth::backdrop::BackdropOpener airtruth_open_backdrop __asm__(
    "airtruth_open_backdrop_" AIRTRUTH_BUILD);
const airtruth::backdrop::BackdropOpener airtruth_open_backdrop =
    &airtruth::backdrop::make_osg_backdrop;
}
