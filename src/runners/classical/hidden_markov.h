// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "runners/detector/detector.h"

namespace airtruth::classical {

// Track before detect: a hidden Markov model of a target that moves slowly over the sphere.
std::unique_ptr<detector::Detector> make_hidden_markov();

}  // namespace airtruth::classical
