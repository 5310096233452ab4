// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string_view>

#include "runners/tracking/tracker.h"

// AM3, re-implemented from the public record: adaptive tracking by multiple-instance learning with
// weighted instances, several classifiers that vote and several resolutions (Fu et al., "Real-time
// Adaptive Multi-Classifier Multi-Resolution Visual Tracking Framework for Unmanned Aerial
// Vehicles", RED-UAS 2013, abstract; the tracker of the E-Vision paper's section IV). Its authors'
// code is not public. Details that the record leaves open are chosen here and marked, and this
// implementation does not claim to reproduce their numbers.
//
// A classifier is a sum of Gaussian log-ratios of Haar-like box sums (Babenko, Yang and Belongie
// 2011, "Robust object tracking with online multiple instance learning", eq. 5 to 8). With
// `weighted` it learns as in Zhang and Song 2013, "Real-time visual tracking via online weighted
// multiple instance learning", eq. 8 to 14: instances of the positive bag have the weight
// exp(-distance), and weak classifiers are chosen by the first-order expansion of the bag
// likelihood. Without `weighted` it chooses greedily by Babenko's noisy-OR.
//
// The following choices are this implementation's own; docs/evaluation.md has their measured
// effect: how levels and voters are combined; that the windows elsewhere with the highest scores
// are learned as negatives (`hard`); that the positive bag shrinks with the object.
namespace airtruth::tracking {

struct Am3Options {
  std::uint64_t seed = 1;
  // In pixels of full resolution.
  int search_radius_px = 40;
  int levels = 3;  // upper bound; small objects use fewer
  int voters = 3;  // number of classifiers at each level
  // Number of weak classifiers that learn.
  int pool = 250;
  // Number of these that are selected to decide.
  int selected = 20;
  // Weight of the previous value when a Gaussian is updated.
  double memory = 0.93;
  // Windows nearer to the object than this distance, and than this share of the object's shorter
  // side, are positives.
  double positive_radius_px = 4;
  double positive_share = 0.25;
  // Gap between the positives and the nearest negatives, after the first frame.
  double gap_px = 2;
  int negatives = 50;
  // Number of further negatives: the windows that looked most like the object.
  int hard = 50;
  bool weighted = true;
  bool follows_scale = false;  // false: the box keeps its first size
};

// Makes "am3"; "am3s", which follows the scale by optical flow and whose classifiers start anew
// whenever the scale has changed by half; and the trackers of Babenko et al. ("mil") and of Zhang
// and Song ("wmil"), one classifier at one resolution. Returns nullptr for any other name.
std::unique_ptr<Tracker> make_am3(std::string_view name, std::uint64_t seed);

}  // namespace airtruth::tracking
