// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <airtruth/lens.h>
#include <airtruth/truth.h>

#include "camera/lens/lens.h"
#include "labels/annotation/truth.h"

// The public forms of lenses and of the truth of a sequence.
namespace airtruth {

// What a public Lens holds.
struct Lens::State {
  lens::Lens lens;
};

Lens public_lens(const lens::Lens& lens);

SequenceTruth public_truth(annotation::Truth truth);

}  // namespace airtruth
