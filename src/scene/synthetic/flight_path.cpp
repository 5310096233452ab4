// SPDX-License-Identifier: Apache-2.0
#include "scene/synthetic/flight_path.h"

#include <cmath>

namespace airtruth::synthetic {
namespace {

constexpr double kRollPeriod_s = 8.5;
constexpr double kPitchPeriod_s = 6.1;
constexpr double kPitchAmplitude_deg = 0.7;
constexpr double kGravity_mps2 = 9.80665;

}  // namespace

FlightPath::FlightPath(const FlightOptions& options)
    : options_(options),
      pitch_(vibration(Seed(options.seed).stream("shake.pitch"), options.shake_deg)),
      yaw_(vibration(Seed(options.seed).stream("shake.yaw"), options.shake_deg)),
      roll_(vibration(Seed(options.seed).stream("shake.roll"), 0.6 * options.shake_deg)) {
  Random random = Seed(options.seed).stream("flight");
  roll_phase_rad_ = random.uniform(0, 2 * kPi);
  pitch_phase_rad_ = random.uniform(0, 2 * kPi);
}

// Tones of equal power from 5 to 15 Hz, one in each band.
FlightPath::Tones FlightPath::vibration(Random random, double rms_deg) {
  Tones tones;
  for (int i = 0; i < kTones; ++i) {
    Tone& tone = tones[static_cast<std::size_t>(i)];
    tone.frequency_hz = 5 + 10 * (i + random.uniform()) / kTones;
    tone.phase_rad = random.uniform(0, 2 * kPi);
    tone.amplitude_deg = rms_deg * std::sqrt(2.0 / kTones);
  }
  return tones;
}

double FlightPath::sum(const Tones& tones, double time_s) {
  double total = 0;
  for (const Tone& tone : tones)
    total += tone.amplitude_deg * std::sin(2 * kPi * tone.frequency_hz * time_s + tone.phase_rad);
  return total;
}

trajectory::State FlightPath::nominal(int index) const {
  const double time_s = index / options_.frame_rate_hz;
  const double rate = 2 * kPi / kRollPeriod_s;
  const double roll_deg = options_.roll_deg * std::sin(rate * time_s + roll_phase_rad_);
  // A coordinated turn: yaw rate = g tan(roll) / speed, integrated for the small sinusoidal roll.
  const double turn = options_.speed_mps > 1 ? kGravity_mps2 / options_.speed_mps : 0.0;
  const double yaw_deg = options_.heading_deg + std::min(turn, 0.5) * options_.roll_deg / rate *
                                                    (std::cos(roll_phase_rad_) -
                                                     std::cos(rate * time_s + roll_phase_rad_));
  const double pitch_deg =
      kPitchAmplitude_deg * std::sin(2 * kPi * time_s / kPitchPeriod_s + pitch_phase_rad_);
  trajectory::State state;
  const double heading = radians(options_.heading_deg);
  const double travel_m = options_.translate ? options_.speed_mps * time_s : 0.0;
  const Vector3 ahead(std::cos(heading), std::sin(heading), 0);
  state.position_in_world = travel_m * ahead - Vector3(0, 0, options_.altitude_m);
  state.velocity_in_world_mps = (options_.translate ? options_.speed_mps : 0.0) * ahead;
  state.world_from_body = world_from_body({yaw_deg, pitch_deg, roll_deg});
  return state;
}

trajectory::State FlightPath::shaken(int index) const {
  trajectory::State state = nominal(index);
  const double time_s = index / options_.frame_rate_hz;
  const YawPitchRoll shake{sum(yaw_, time_s), sum(pitch_, time_s), sum(roll_, time_s)};
  state.world_from_body = (state.world_from_body * world_from_body(shake)).normalized();
  return state;
}

}  // namespace airtruth::synthetic
