// SPDX-License-Identifier: Apache-2.0
#include "encounter/sets/draw_encounter.h"

#include <utility>

#include <fmt/format.h>

#include "foundation/base/error.h"

namespace airtruth::encounter {
namespace {

// Tracks that circle may come closer at another time in every draw of the pairing.
constexpr std::uint64_t kMaxTracks = 100;
// Where the tracks of a next attempt begin; sets are smaller.
constexpr std::uint64_t kNextAttempt = std::uint64_t{1} << 40;

Track own_of(Track own) {
  own.name = "own";
  return with_velocities(std::move(own));
}

}  // namespace

DrawEncounter model_tracks(std::shared_ptr<const Sampler> sampler) {
  return [sampler = std::move(sampler)](std::uint64_t index) {
    SampledTrack sampled = sampler->sample(index);
    sampled.track.name = "track";
    return DrawnEncounter{{{std::move(sampled.track)}, 1}, sampled.draws};
  };
}

DrawEncounter model_pairs(std::shared_ptr<const Sampler> sampler,
                          Track own,
                          const PairingOptions& options,
                          std::uint64_t seed) {
  return [sampler = std::move(sampler), own = own_of(std::move(own)), options, seed](
             std::uint64_t index) {
    Random random = Seed(seed).stream("pairing", index);
    DrawnEncounter drawn{{{own}, 1}, 0};
    for (std::uint64_t attempt = 0; attempt < kMaxTracks; ++attempt) {
      SampledTrack sampled = sampler->sample(index + attempt * kNextAttempt);
      drawn.draws += sampled.draws;
      Track& intruder = sampled.track;
      intruder.name = "intruder";
      for (double& time_s : intruder.times_s) time_s += own.times_s.front();
      const auto pairing = pair(own, intruder, options, random);
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

DrawEncounter geometric_pairs(const GeometricSampler& sampler, Track own) {
  return [sampler, own = own_of(std::move(own))](std::uint64_t index) {
    return DrawnEncounter{
        {{own, geometric_track(own, sampler.draw(index), own.times_s.front(), own.times_s.back())},
         1},
        1};
  };
}

}  // namespace airtruth::encounter
