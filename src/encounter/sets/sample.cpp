// SPDX-License-Identifier: Apache-2.0
#include "encounter/sets/sample.h"

#include <cmath>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "encounter/encounter_model/model_file.h"
#include "encounter/encounter_model/sampler.h"
#include "encounter/pairing/distribution.h"
#include "encounter/pairing/geometric.h"
#include "encounter/pairing/pair.h"
#include "encounter/tracks_file/tracks_file.h"
#include "foundation/base/error.h"

namespace airtruth::sets {
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
  return geometric_pairs(pairing::GeometricSampler(options, request.seed, request.size()), own);
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

}  // namespace airtruth::sets
