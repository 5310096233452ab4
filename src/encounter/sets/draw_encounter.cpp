// SPDX-License-Identifier: Apache-2.0
#include "encounter/sets/draw_encounter.h"

#include <cmath>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "foundation/base/error.h"

namespace airtruth::sets {
namespace {

// Tracks that circle may come closer at another time in every draw of the pairing.
constexpr std::uint64_t kMaxTracks = 100;
// Where the tracks of a next attempt begin; sets are smaller.
constexpr std::uint64_t kNextAttempt = std::uint64_t{1} << 40;

// The own track with a sample in each second of the intruder, so that tools which want both at the
// same time find them.
track::Track own_of(track::Track own, int seconds) {
  own.name = "own";
  std::vector<double> times_s;
  for (int i = 0; i <= seconds; ++i) times_s.push_back(own.times_s.front() + i);
  return track::with_samples_at(track::with_velocities(std::move(own)), times_s);
}

}  // namespace

DrawEncounter model_tracks(std::shared_ptr<const encounter_model::Sampler> sampler) {
  return [sampler = std::move(sampler)](std::uint64_t index) {
    encounter_model::SampledTrack sampled = sampler->sample(index);
    sampled.track.name = "track";
    return DrawnEncounter{{{std::move(sampled.track)}, 1}, sampled.draws};
  };
}

DrawEncounter model_pairs(std::shared_ptr<const encounter_model::Sampler> sampler,
                          track::Track own,
                          const pairing::PairingOptions& options,
                          std::uint64_t seed) {
  own = own_of(std::move(own), sampler->duration_s());
  return [sampler = std::move(sampler), own = std::move(own), options, seed](std::uint64_t index) {
    Random random = Seed(seed).stream("pairing", index);
    DrawnEncounter drawn{{{own}, 1}, 0};
    for (std::uint64_t attempt = 0; attempt < kMaxTracks; ++attempt) {
      encounter_model::SampledTrack sampled = sampler->sample(index + attempt * kNextAttempt);
      drawn.draws += sampled.draws;
      track::Track& intruder = sampled.track;
      intruder.name = "intruder";
      for (double& time_s : intruder.times_s) time_s += own.times_s.front();
      const auto pairing = pairing::pair(own, intruder, options, random);
      if (!pairing) continue;
      drawn.encounter.weight = pairing->weight;
      drawn.encounter.aircraft.push_back(std::move(intruder));
      return drawn;
    }
    throw Error(
        fmt::format("none of {} tracks for encounter {} passes the own one as drawn; "
                    "expected a wider range of miss distances",
                    kMaxTracks,
                    index + 1));
  };
}

DrawEncounter geometric_pairs(const pairing::GeometricSampler& sampler, track::Track own) {
  const double length_s = own.times_s.back() - own.times_s.front();
  if (length_s > encounter_model::kMaxDuration_s)
    throw Error(fmt::format("the own track is {} s long; expected up to {} s",
                            length_s,
                            encounter_model::kMaxDuration_s));
  own = own_of(std::move(own), static_cast<int>(std::ceil(length_s)));
  return [sampler, own = std::move(own)](std::uint64_t index) {
    return DrawnEncounter{{{own,
                            pairing::geometric_track(
                                own, sampler.draw(index), own.times_s.front(), own.times_s.back())},
                           1},
                          1};
  };
}

}  // namespace airtruth::sets
