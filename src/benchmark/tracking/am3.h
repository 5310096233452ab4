// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>

#include "benchmark/tracking/tracker.h"

// AM3, re-implemented from the public record: adaptive tracking by multiple-instance learning with
// weighted instances, several classifiers that vote and several resolutions (Fu et al., "Real-time
// Adaptive Multi-Classifier Multi-Resolution Visual Tracking Framework for Unmanned Aerial
// Vehicles", RED-UAS 2013, abstract; the tracker of the E-Vision paper's section IV). Its authors'
// code is not public: what the record leaves open is chosen here and marked, and no equality with
// their numbers is claimed.
//
// A classifier is a sum of Gaussian log-ratios of Haar-like box sums (Babenko, Yang and Belongie
// 2011, "Robust object tracking with online multiple instance learning", eq. 5 to 8). `weighted`
// learns by Zhang and Song 2013, "Real-time visual tracking via online weighted multiple instance
// learning", eq. 8 to 14: instances of the positive bag count by exp(-distance), and weak
// classifiers are chosen by the first-order expansion of the bag likelihood. Otherwise by Babenko's
// noisy-OR, greedily.
//
// Chosen here, and measured in docs/evaluation.md: how levels and voters are put together; that the
// windows which looked most like the object elsewhere are learned as what it is not (`hard`); that
// the positive bag shrinks with the object.
namespace airtruth::tracking {

struct Am3Options {
  std::uint64_t seed = 1;
  int search_radius_px = 40;  // full resolution
  int levels = 3;             // at most; fewer for small objects
  int voters = 3;             // classifiers at each level
  int pool = 250;             // weak classifiers that learn
  int selected = 20;          // of them that decide
  double memory = 0.93;       // share of the old in what is learned
  // Windows nearer than this, and than this share of the object's shorter side, are the object.
  double positive_radius_px = 4;
  double positive_share = 0.25;
  double gap_px = 2;  // from them to the nearest that are not, after the first frame
  int negatives = 50;
  int hard = 50;  // and of those that looked most like it
  bool weighted = true;
  bool follows_scale = false;  // else the box keeps its first size
};

Am3Options am3_options(std::uint64_t seed);
// AM3 with its scale followed by flow (scale.h), and its classifiers begun anew whenever it has
// changed by half.
Am3Options am3s_options(std::uint64_t seed);
// Babenko's and Zhang and Song's trackers: one classifier, one resolution.
Am3Options mil_options(std::uint64_t seed);
Am3Options wmil_options(std::uint64_t seed);

std::unique_ptr<Tracker> make_am3(const Am3Options& options);

}  // namespace airtruth::tracking
