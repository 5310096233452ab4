// SPDX-License-Identifier: Apache-2.0
#include "encounter/sets/sets.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "encounter/encounter_model/model_file.h"
#include "encounter/tracks_file/tracks_file.h"
#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/base/in_parallel.h"

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
    pairing::GeometricPassage passage =
        pairing::geometric_passage(sampler, index, own, own.times_s.front(), own.times_s.back());
    return DrawnEncounter{{{own, std::move(passage.track)}, 1}, passage.draws};
  };
}

namespace {

// The length of a track where nothing states it.
constexpr int kDuration_s = 60;

track::Track own_track(const std::string& file) {
  track::Track own = tracks_file::read_encounters(file).front().aircraft.front();
  if (own.size() < 2)
    throw Error("the own aircraft has one sample; expected a track of two or more", {file});
  return own;
}

// Whole seconds that the intruder flies: stated, or those of the own track.
int duration_of(const SampleRequest& request, const std::optional<track::Track>& own) {
  if (request.duration_s) return *request.duration_s;
  if (!own) return kDuration_s;
  const double length_s = std::ceil(own->times_s.back() - own->times_s.front());
  if (length_s > encounter_model::kMaxDuration_s)
    throw Error(fmt::format("the own track is {} s long; expected up to {} s, or {}",
                            length_s,
                            encounter_model::kMaxDuration_s,
                            request.name_of("duration_s")),
                {request.own});
  return static_cast<int>(length_s);
}

double cpa_time_of(const SampleRequest& request, const track::Track& own) {
  return request.cpa_time_s.value_or((own.times_s.front() + own.times_s.back()) / 2);
}

// The distribution of a range, or of its default.
pairing::Distribution distribution(const SampleRequest& request,
                                   const char* member,
                                   const std::vector<double>& edges,
                                   const std::vector<double>& otherwise,
                                   const std::vector<double>& shares = {}) {
  return pairing::Distribution(edges.empty() ? otherwise : edges, shares, request.name_of(member));
}

pairing::Distribution hmd_m(const SampleRequest& request) {
  return distribution(request, "hmd_m", request.hmd_m, {-500, 500}, request.hmd_shares);
}

pairing::Distribution vmd_m(const SampleRequest& request) {
  return distribution(request, "vmd_m", request.vmd_m, {-150, 150}, request.vmd_shares);
}

DrawEncounter geometric(const SampleRequest& request, const track::Track& own) {
  const pairing::GeometricOptions options{
      .course_deg = distribution(request, "course_deg", request.course_deg, {-180, 180}),
      .speed_mps = distribution(request, "speed_mps", request.speed_mps, {30, 80}),
      .hmd_m = hmd_m(request),
      .vmd_m = vmd_m(request),
      .climb_mps = distribution(request, "climb_mps", request.climb_mps, {0}),
      .turn_rate_dps = distribution(request, "turn_rate_dps", request.turn_rate_dps, {0}),
      .cpa_time_s = distribution(request, "cpa_time_s", {cpa_time_of(request, own)}, {})};
  const auto count = static_cast<std::uint64_t>(std::max<std::int64_t>(0, request.count));
  return geometric_pairs(pairing::GeometricSampler(options, request.seed, count), own);
}

std::shared_ptr<const encounter_model::Sampler> sampler_of(const SampleRequest& request,
                                                           const std::optional<track::Track>& own) {
  encounter_model::SampleOptions options{
      request.seed, duration_of(request, own), {request.domain, request.airspace, {}}};
  if (request.altitude_ft.size() != 0 && request.altitude_ft.size() != 2)
    throw Error(request.name_of("altitude_ft") + " is not two numbers, lowest and highest");
  if (!request.altitude_ft.empty())
    options.cut.altitude_ft = {request.altitude_ft[0], request.altitude_ft[1]};
  return std::make_shared<const encounter_model::Sampler>(
      encounter_model::read_model(request.model), options);
}

pairing::PairingOptions pairing_of(const SampleRequest& request, const track::Track& own) {
  pairing::PairingOptions options;
  options.cpa_time_s = cpa_time_of(request, own);
  options.hmd_m = hmd_m(request);
  options.vmd_m = vmd_m(request);
  return options;
}

void refuse_unused(const SampleRequest& request) {
  const auto refuse = [&](const char* member, bool is_stated, const std::string& why) {
    if (is_stated) throw Error(fmt::format("{} {}", request.name_of(member), why));
  };
  const std::string of_model = "belongs to an encounter model; the model is geometric";
  const std::string of_geometry = "belongs to geometric encounters; the model is a file";
  const std::string of_encounters =
      "belongs to encounters; expected " + request.name_of("own") + ", the track to pair with";
  if (request.is_geometric()) {
    refuse("duration_s", request.duration_s.has_value(), of_model);
    refuse("domain", !request.domain.empty(), of_model);
    refuse("airspace", !request.airspace.empty(), of_model);
    refuse("altitude_ft", !request.altitude_ft.empty(), of_model);
  } else {
    refuse("course_deg", !request.course_deg.empty(), of_geometry);
    refuse("speed_mps", !request.speed_mps.empty(), of_geometry);
    refuse("climb_mps", !request.climb_mps.empty(), of_geometry);
    refuse("turn_rate_dps", !request.turn_rate_dps.empty(), of_geometry);
  }
  if (!request.own.empty()) return;
  if (request.is_geometric())
    throw Error(request.name_of("own") +
                " is missing; geometric encounters are placed about an own track");
  refuse("cpa_time_s", request.cpa_time_s.has_value(), of_encounters);
  refuse("hmd_m", !request.hmd_m.empty(), of_encounters);
  refuse("hmd_shares", !request.hmd_shares.empty(), of_encounters);
  refuse("vmd_m", !request.vmd_m.empty(), of_encounters);
  refuse("vmd_shares", !request.vmd_shares.empty(), of_encounters);
}

}  // namespace

SampledSet sampled_set(const SampleRequest& request) {
  refuse_unused(request);
  std::optional<track::Track> own;
  if (!request.own.empty()) own = own_track(request.own);
  if (request.is_geometric()) return {geometric(request, *own), 1};
  const auto sampler = sampler_of(request, own);
  return {own ? model_pairs(sampler, *own, pairing_of(request, *own), request.seed)
              : model_tracks(sampler),
          sampler->share()};
}

namespace {

// A thread draws a block at a time; a window of blocks stands in memory.
constexpr std::uint64_t kBlock = 64;
constexpr std::uint64_t kBlocksOfWindow = 32;
// The number of encounters is 32 bits wide in a waypoint file.
constexpr std::int64_t kMaxCount = 0xffffffff;

struct Block {
  std::string bytes;
  std::vector<track::Encounter> encounters;  // where the bytes are those of all of them at once
  SetSummary summary;
};

void add(SetSummary& sum, const SetSummary& more) {
  sum.encounters += more.encounters;
  sum.draws += more.draws;
  sum.weight_sum += more.weight_sum;
  sum.weight_squares += more.weight_squares;
}

// The bytes are those of `format`, where it is given.
Block drawn_block(const DrawEncounter& draw,
                  std::uint64_t begin,
                  std::uint64_t end,
                  std::optional<tracks_file::TracksFormat> format) {
  Block block;
  for (std::uint64_t i = begin; i < end; ++i) {
    DrawnEncounter drawn = draw(i);
    const double weight = drawn.encounter.weight;
    add(block.summary, {1, static_cast<std::uint64_t>(drawn.draws), weight, weight * weight});
    const auto aircraft = static_cast<std::uint32_t>(drawn.encounter.aircraft.size());
    if (format)
      block.bytes += tracks_file::bytes_of(drawn.encounter, *format, i + 1, aircraft);
    else
      block.encounters.push_back(std::move(drawn.encounter));
  }
  return block;
}

// Calls take(block) for each block in order.
template <typename Take>
void for_each_block(const DrawEncounter& draw,
                    const EncounterOptions& options,
                    std::optional<tracks_file::TracksFormat> format,
                    const Take& take) {
  const auto count = static_cast<std::uint64_t>(options.count);
  const std::uint64_t blocks = (count + kBlock - 1) / kBlock;
  for (std::uint64_t first = 0; first < blocks; first += kBlocksOfWindow) {
    std::vector<Block> window(std::min(kBlocksOfWindow, blocks - first));
    const auto draw_one = [&](std::size_t k) {
      const std::uint64_t begin = (first + k) * kBlock;
      window[k] = drawn_block(draw, begin, std::min(begin + kBlock, count), format);
    };
    in_parallel(window.size(), options.jobs, draw_one, {}, options.stop);
    for (Block& block : window) take(block);
    if (options.progress)
      options.progress(static_cast<std::int64_t>(std::min((first + window.size()) * kBlock, count)),
                       options.count);
  }
}

void expect_count(std::int64_t count, std::int64_t most) {
  if (count < 1 || count > most)
    throw Error(fmt::format("{} encounters are asked for; expected 1 to {}", count, most));
}

}  // namespace

DrawnSet draw_set(const DrawEncounter& draw, const EncounterOptions& options) {
  expect_count(options.count, kMaxInMemory);
  DrawnSet set;
  for_each_block(draw, options, {}, [&](Block& block) {
    add(set.summary, block.summary);
    std::move(block.encounters.begin(), block.encounters.end(), std::back_inserter(set.encounters));
  });
  return set;
}

SetSummary write_set(const std::filesystem::path& file,
                     const DrawEncounter& draw,
                     const EncounterOptions& options) {
  expect_count(options.count, kMaxCount);
  const tracks_file::TracksFormat format = tracks_file::tracks_format_of(file);
  if (!tracks_file::holds_many(format)) {
    DrawnSet set = draw_set(draw, options);
    tracks_file::write_encounters(file,
                                  tracks_file::fitted(std::move(set.encounters), format, file));
    return set.summary;
  }
  SetSummary summary;
  const auto aircraft = static_cast<std::uint32_t>(draw(0).encounter.aircraft.size());
  write_file(file, [&](const AddBytes& add_bytes) {
    add_bytes(tracks_file::head_of(format, static_cast<std::uint32_t>(options.count), aircraft));
    for_each_block(draw, options, format, [&](const Block& block) {
      add(summary, block.summary);
      add_bytes(block.bytes);
    });
  });
  return summary;
}

}  // namespace airtruth::sets
