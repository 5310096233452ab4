// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "foundation/base/seed.h"
#include "scene/synthetic/flight.h"
#include "scene/trajectory/path.h"

namespace airtruth::synthetic {

// The pose of the camera and its shake. Both are closed forms of time, so that frames can be
// computed in any order.
class FlightPath {
 public:
  explicit FlightPath(const FlightOptions& options);
  trajectory::State nominal(int index) const;
  trajectory::State shaken(int index) const;

 private:
  struct Tone {
    double frequency_hz = 0;
    double phase_rad = 0;
    double amplitude_deg = 0;
  };
  static constexpr int kTones = 7;
  using Tones = std::array<Tone, kTones>;
  static Tones vibration(Random random, double rms_deg);
  static double sum(const Tones& tones, double time_s);

  FlightOptions options_;
  Tones pitch_, yaw_, roll_;
  double roll_phase_rad_ = 0;
  double pitch_phase_rad_ = 0;
};

}  // namespace airtruth::synthetic
