// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "aircraft/wrapper/condition.h"
#include "aircraft/wrapper/wrapper.h"

namespace airtruth::aircraft {

// All that a wrapper derives from the state at cruise, as text: whether each condition holds, and
// the value of each animation. Two states with the same outcomes give the same model.
std::string outcomes_of(const Wrapper& wrapper, const Cruise& cruise);

}  // namespace airtruth::aircraft
