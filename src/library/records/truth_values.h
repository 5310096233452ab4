// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <airtruth/truth.h>

#include "labels/annotation/truth.h"

// The public form of the truth, whose vectors are arrays.
namespace airtruth {

FrameTruth public_truth(const annotation::Frame& frame);
SequenceTruth public_truth(const annotation::Truth& truth);

}  // namespace airtruth
