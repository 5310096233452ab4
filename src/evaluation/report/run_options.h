// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <stop_token>
#include <vector>

#include "dataset/sequences/condition.h"
#include "foundation/base/log.h"

namespace airtruth::report {

// How an evaluation of trackers or of detectors runs.
struct RunOptions {
  // True: the videos are read, for results by contrast and for the page's pictures.
  bool with_film = true;
  // Number of videos read at a time; 0 means one per core.
  int jobs = 0;
  // Sequences for which these do not hold are left out of every measure.
  std::vector<sequences::Condition> where;
  Warn warn;
  // Counts videos that were read.
  std::function<void(std::int64_t done, std::int64_t total)> progress;
  std::stop_token stop;
};

}  // namespace airtruth::report
