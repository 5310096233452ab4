// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "labels/annotation/truth.h"

namespace airtruth::annotation {

// Describes the first inconsistency of a frame's truth; empty where it is consistent. The rules
// are: numbers are finite, a visible box is present exactly where the intruder is visible, a
// position is present exactly where it is in the world, and fractions lie within 0..1.
std::optional<std::string> fault(const Frame& frame);
std::optional<std::string> fault(const LensFacts& lens);

}  // namespace airtruth::annotation
