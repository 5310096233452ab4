// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "encounter/track/track.h"
#include "foundation/base/error.h"

// Rows of a file, one state of one aircraft each, put together to tracks.
namespace airtruth::tracks_file {

// The largest number of aircraft in one encounter: a bound for untrusted files.
constexpr std::size_t kMaxAircraft = 1000;

class TrackBuilder {
 public:
  // Adds a state. Throws Error where the time is not after the last one of the same aircraft, or
  // there are too many aircraft.
  void add(const std::string& name,
           double time_s,
           const Vector3& position_ned_m,
           const Vector3* velocity_ned_mps,
           const Where& where);
  bool is_empty() const { return encounter_.aircraft.empty(); }
  // Hands over what was added and begins anew.
  track::Encounter take();

 private:
  track::Encounter encounter_;
  std::map<std::string, std::size_t> places_;
  std::size_t last_ = 0;
};

}  // namespace airtruth::tracks_file
