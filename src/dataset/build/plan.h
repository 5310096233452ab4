// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <stop_token>
#include <string>
#include <vector>

#include "dataset/catalogue/expand.h"

namespace airtruth::dataset {

// Lowest, highest and middle of many numbers in bounded memory: of more than 65,536 the median is
// that of every second, every fourth, ... of them.
class Spread {
 public:
  void add(double value);
  std::int64_t count() const { return count_; }
  // Of at least one number.
  double low() const { return low_; }
  double high() const { return high_; }
  double median() const;

 private:
  std::int64_t count_ = 0;
  std::int64_t every_ = 1;
  double low_ = 0;
  double high_ = 0;
  std::vector<double> kept_;
};

// What a catalogue would make. Nothing is rendered; of videos the head is read.
struct Plan {
  std::int64_t sequences = 0;
  std::int64_t negatives = 0;   // sequences without an intruder
  std::int64_t intruders = 0;   // of all sequences
  std::int64_t frames = 0;      // of sequences whose length is known
  std::int64_t open_ended = 0;  // sequences to the end of a video whose length is not known
  // Intruders by type and by livery: "738" -> "738/738-Ryanair" -> 12. A model file is its own
  // type.
  std::map<std::string, std::map<std::string, std::int64_t>> aircraft;
  Spread sizes_px;                             // that were drawn
  Spread ranges_m;                             // that were drawn
  std::int64_t not_flyable = 0;                // intruders whose path their class cannot fly
  std::vector<std::string> not_flyable_words;  // of the first kMostNamed: "NAME: why"
  static constexpr std::size_t kMostNamed = 5;
  double core_s = 0;         // seconds of one core, the next included
  double calibration_s = 0;  // for the cameras that are measured, each background once
  double bytes = 0;
};

// `each` is called for every sequence in order. Error as of video::Reader for a background whose
// video cannot be read; Interrupted on stop.
Plan plan_of(const Catalogue& catalogue,
             const std::function<void(const Item&)>& each,
             const std::stop_token& stop);

}  // namespace airtruth::dataset
