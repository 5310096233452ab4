// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "truth/annotation/truth.h"

namespace airtruth::annotation {

// What is wrong with a frame's truth, in words; empty where it is consistent: finite numbers, a
// visible box exactly where the intruder is visible, a position exactly where it is in the world,
// fractions within 0..1.
std::optional<std::string> fault(const Frame& frame);
std::optional<std::string> fault(const LensFacts& lens);

}  // namespace airtruth::annotation
