// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <airtruth/truth.h>

#include "labels/annotation/truth.h"

// The public form of the truth, whose vectors are arrays, and back.
namespace airtruth {

FrameTruth public_truth(const annotation::Frame& frame);
SequenceTruth public_truth(const annotation::Truth& truth);
annotation::Frame annotation_of(const FrameTruth& truth);

}  // namespace airtruth
