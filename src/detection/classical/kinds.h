// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "detection/classical/blobs.h"
#include "detection/detector/detector.h"

// What the classical detectors share; only this module includes it.
namespace airtruth::detection {

// Weaker blobs are noise more often than not at any size: in a frame of 1280x960 white noise a
// sample of some thousand independent ones exceeds this many standard deviations.
inline constexpr double kLeastContrastToNoise = 4;

// The blobs as detections, the strongest first, without those below `least` and without a weaker
// one of the same object. Scores are the contrast-to-noise ratios, to four digits.
std::vector<Detection> detections_of(std::vector<Blob> blobs, double least);

std::unique_ptr<Detector> make_close_minus_open();
std::unique_ptr<Detector> make_hidden_markov();
std::unique_ptr<Detector> make_frame_difference();

}  // namespace airtruth::detection
