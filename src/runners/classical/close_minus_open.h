// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "runners/detector/detector.h"

namespace airtruth::classical {

// Close-minus-open of single frames, confirmed at the same bearing in the frames before.
std::unique_ptr<detector::Detector> make_close_minus_open();

}  // namespace airtruth::classical
