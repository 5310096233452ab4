// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "runners/detector/detector.h"

namespace airtruth::classical {

// What differs from the frame before, once the camera's turn is taken out.
std::unique_ptr<detector::Detector> make_frame_difference();

}  // namespace airtruth::classical
