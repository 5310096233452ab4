// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <airtruth/lens.h>

#include "camera/lens/lens.h"

// The public form of lenses.
namespace airtruth {

// What a public Lens holds.
struct Lens::State {
  lens::Lens lens;
};

Lens public_lens(const lens::Lens& lens);

}  // namespace airtruth
