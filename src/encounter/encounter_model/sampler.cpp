// SPDX-License-Identifier: Apache-2.0
#include "encounter/encounter_model/sampler.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "foundation/base/error.h"
#include "foundation/geometry/units.h"

namespace airtruth::encounter_model {
namespace {

// Number of combinations that are summed: it bounds the time.
constexpr std::size_t kMaxCombinations = 1'000'000;

// What is kept of each bin of each initial variable: 1 for all, 0 for nothing.
using Kept = std::vector<std::vector<double>>;

void keep_bins(Kept& kept,
               const std::vector<std::size_t>& numbers,
               std::optional<std::size_t> variable,
               const char* what,
               const BayesModel& model) {
  if (numbers.empty()) return;
  if (!variable)
    throw Error(fmt::format("has no {}; expected no cut by it", what), {model.file.string()});
  std::vector<double>& bins = kept[*variable];
  std::ranges::fill(bins, 0.0);
  for (const std::size_t number : numbers) {
    if (number < 1 || number > bins.size())
      throw Error(fmt::format("has no {} {}; expected 1 to {}", what, number, bins.size()),
                  {model.file.string()});
    bins[number - 1] = 1;
  }
}

// `variable` and everything that it depends on.
void add_with_ancestors(const BayesModel& model, std::size_t variable, std::vector<bool>& chosen) {
  if (chosen[variable]) return;
  chosen[variable] = true;
  for (const std::size_t parent : model.initial[variable].parents)
    add_with_ancestors(model, parent, chosen);
}

std::vector<std::size_t> bins_of(const BayesModel& model) {
  std::vector<std::size_t> bins;
  for (const Node& node : model.initial) bins.push_back(node.bins);
  for (const Node& node : model.transition) bins.push_back(node.bins);
  return bins;
}

std::size_t combinations_of(const BayesModel& model, const std::vector<std::size_t>& variables) {
  std::size_t count = 1;
  for (const std::size_t variable : variables) {
    count *= model.initial[variable].bins;
    if (count > kMaxCombinations)
      throw Error(
          fmt::format("the cut depends on more than {} combinations of bins; expected fewer",
                      kMaxCombinations),
          {model.file.string()});
  }
  return count;
}

// The column of a node's table for the bins of all variables.
std::size_t column_of(const Node& node,
                      const std::vector<std::size_t>& bins_of_variable,
                      const std::size_t* bins) {
  std::size_t column = 0;
  for (std::size_t i = node.parents.size(); i-- > 0;)
    column = column * bins_of_variable[node.parents[i]] + bins[node.parents[i]];
  return column;
}

// 0 where the column has no counts.
double probability_of(const Node& node, std::size_t column, std::size_t bin) {
  const double* sums = &node.sums[column * node.bins];
  const double total = sums[node.bins - 1];
  return total > 0 ? (sums[bin] - (bin == 0 ? 0 : sums[bin - 1])) / total : 0;
}

}  // namespace

CutTable::CutTable(const BayesModel& model, const Cut& cut) {
  Kept kept;
  for (const Node& node : model.initial) kept.emplace_back(node.bins, 1.0);
  keep_bins(kept, cut.domains, model.places.domain, "geographic domain", model);
  keep_bins(kept, cut.airspaces, model.places.airspace, "airspace class", model);
  set_altitudes(model, cut);
  const std::vector<double>& edges = model.edges[*model.places.altitude_ft];
  for (std::size_t bin = 0; bin < altitudes_ft_.size(); ++bin)
    kept[*model.places.altitude_ft][bin] = altitudes_ft_[bin][1] / (edges[bin + 1] - edges[bin]);
  std::vector<bool> chosen(model.initial.size(), false);
  if (!cut.domains.empty()) add_with_ancestors(model, *model.places.domain, chosen);
  if (!cut.airspaces.empty()) add_with_ancestors(model, *model.places.airspace, chosen);
  if (cut.altitude_ft) add_with_ancestors(model, *model.places.altitude_ft, chosen);
  for (const std::size_t variable : model.initial_order)
    if (chosen[variable]) variables_.push_back(variable);
  if (!variables_.empty()) set_table(model, kept);
}

void CutTable::set_altitudes(const BayesModel& model, const Cut& cut) {
  const std::vector<double>& edges = model.edges[*model.places.altitude_ft];
  const auto range = cut.altitude_ft.value_or(std::array{edges.front(), edges.back()});
  if (!(range[0] < range[1]))
    throw Error(fmt::format("the altitudes {} to {} ft are no range; expected the lower one first",
                            range[0],
                            range[1]));
  for (std::size_t bin = 0; bin + 1 < edges.size(); ++bin) {
    const double low = std::max(edges[bin], range[0]);
    altitudes_ft_.push_back({low, std::max(0.0, std::min(edges[bin + 1], range[1]) - low)});
  }
}

void CutTable::set_table(const BayesModel& model, const Kept& kept) {
  const std::vector<std::size_t> bins_of_variable = bins_of(model);
  const std::size_t count = combinations_of(model, variables_);
  std::vector<std::size_t> bins(model.initial.size(), 0);
  double sum = 0;
  for (std::size_t c = 0; c < count; ++c) {
    std::size_t rest = c;
    for (const std::size_t variable : variables_) {
      bins[variable] = rest % bins_of_variable[variable];
      rest /= bins_of_variable[variable];
    }
    double probability = 1;
    for (const std::size_t variable : variables_) {
      const std::size_t column = column_of(model.initial[variable], bins_of_variable, bins.data());
      probability *= kept[variable][bins[variable]] *
                     probability_of(model.initial[variable], column, bins[variable]);
    }
    if (!(probability > 0)) continue;
    sums_.push_back(sum += probability);
    for (const std::size_t variable : variables_) combinations_.push_back(bins[variable]);
  }
  if (sums_.empty())
    throw Error("has no traffic in the cut by domain, airspace and altitude; expected a wider cut",
                {model.file.string()});
  share_ = std::min(sum, 1.0);
}

void CutTable::draw(Random& random, std::size_t* bins) const {
  if (variables_.empty()) return;
  const double wanted = (1 - random.uniform()) * sums_.back();
  const auto found = std::ranges::lower_bound(sums_, wanted);
  const std::size_t at = static_cast<std::size_t>(found - sums_.begin()) * variables_.size();
  for (std::size_t i = 0; i < variables_.size(); ++i) bins[variables_[i]] = combinations_[at + i];
}

namespace {

// Of the published models nine draws in ten and more can be flown.
constexpr int kMaxDraws = 10'000;

// The first bin whose running sum reaches a random share of the total (select_random of the public
// code). The share is above 0, so that a bin without counts is never drawn.
std::size_t drawn_bin(const double* sums, std::size_t bins, Random& random) {
  const double wanted = (1 - random.uniform()) * sums[bins - 1];
  std::size_t bin = 0;
  while (bin + 1 < bins && sums[bin] < wanted) ++bin;
  return bin;
}

double drawn_value(const std::array<double, 2>& range, Random& random) {
  return range[1] > 0 ? range[0] + range[1] * random.uniform() : range[0];
}

std::vector<std::array<double, 2>> ranges_of(const std::vector<double>& edges, double unit) {
  std::vector<std::array<double, 2>> ranges;
  for (std::size_t bin = 0; bin + 1 < edges.size(); ++bin) {
    if (edges[bin] < 0 && edges[bin + 1] > 0)
      ranges.push_back({0, 0});
    else
      ranges.push_back({edges[bin] * unit, (edges[bin + 1] - edges[bin]) * unit});
  }
  return ranges;
}

}  // namespace

Sampler::Sampler(BayesModel model, const SampleOptions& options)
    : model_(std::move(model)),
      options_(options),
      cut_(model_, options.cut),
      bins_of_(bins_of(model_)),
      is_cut_(model_.initial.size(), false) {
  if (options.duration_s < 1 || options.duration_s > kMaxDuration_s)
    throw Error(fmt::format(
        "a track of {} s is asked for; expected 1 to {} s", options.duration_s, kMaxDuration_s));
  for (const std::size_t variable : cut_.variables()) is_cut_[variable] = true;
  const VariablePlaces& places = model_.places;
  if (places.speed_kt) speeds_ = ranges_of(model_.edges[*places.speed_kt], kMpsOfKnot);
  rate_variables_ = {places.acceleration_ktps, places.vertical_rate_ftpmin, places.turn_rate_dps};
  const std::array<double, kRates> units = {kMpsOfKnot, kMpsOfFootPerMinute, radians(1)};
  for (std::size_t rate = 0; rate < kRates; ++rate)
    if (const auto variable = rate_variables_[rate])
      ranges_[rate] = ranges_of(model_.edges[*variable], units[rate]);
  for (const DynamicVariable& variable : model_.dynamic) {
    const auto found = std::ranges::find(rate_variables_, std::optional(variable.now));
    if (found == rate_variables_.end())
      throw Error(fmt::format("changes '{}' in time; expected only '\\dot v', '\\dot h' and "
                              "'\\dot \\psi' to change",
                              model_.labels[variable.now]),
                  {model_.file.string()});
    rate_of_dynamic_.push_back(static_cast<std::size_t>(found - rate_variables_.begin()));
  }
}

bool Sampler::draw_initial(Random& random, std::size_t* bins) const {
  cut_.draw(random, bins);
  for (const std::size_t variable : model_.initial_order) {
    if (is_cut_[variable]) continue;
    const Node& node = model_.initial[variable];
    const double* sums = &node.sums[column_of(node, bins_of_, bins) * node.bins];
    if (!(sums[node.bins - 1] > 0)) return false;
    bins[variable] = drawn_bin(sums, node.bins, random);
  }
  return true;
}

void Sampler::step(Random& random, std::size_t* bins) const {
  const std::size_t first = model_.initial.size();
  for (const std::size_t i : model_.transition_order) {
    const Node& node = model_.transition[i];
    const double* sums = &node.sums[column_of(node, bins_of_, bins) * node.bins];
    bins[first + i] =
        sums[node.bins - 1] > 0 ? drawn_bin(sums, node.bins, random) : bins[model_.dynamic[i].now];
  }
  for (const DynamicVariable& variable : model_.dynamic) bins[variable.now] = bins[variable.next];
}

// An aircraft in flight, and the rates at which it changes during the present second.
struct Sampler::Flight {
  Vector3 position_m = Vector3::Zero();
  double speed_mps = 0;
  // Direction of the nose over the ground.
  double north = 1, east = 0;
  std::array<double, kRates> rates{};
  // Of half the angle turned in a second.
  double half_cos = 1, half_sin = 0;

  void set(std::size_t rate, double value) {
    rates[rate] = value;
    if (rate != kTurnRate) return;
    half_cos = std::cos(value / 2);
    half_sin = std::sin(value / 2);
  }
  double horizontal_mps(double airspeed_mps) const {
    const double square = airspeed_mps * airspeed_mps - rates[kVerticalRate] * rates[kVerticalRate];
    return std::sqrt(std::max(0.0, square));
  }
  Vector3 velocity_mps() const {
    const double horizontal = horizontal_mps(speed_mps);
    return {horizontal * north, horizontal * east, -rates[kVerticalRate]};
  }
  void turn_half() {
    const double n = north * half_cos - east * half_sin;
    east = north * half_sin + east * half_cos;
    north = n;
  }
  // Flies one second: the chord of an arc is in the direction of its middle, and shorter than the
  // arc by sin(x) / x, where x is half the angle turned.
  void advance() {
    const double next_mps = speed_mps + rates[kAcceleration];
    const double mean_mps = (horizontal_mps(speed_mps) + horizontal_mps(next_mps)) / 2;
    const double half = rates[kTurnRate] / 2;
    const double chord_m = half == 0 ? mean_mps : mean_mps * half_sin / half;
    turn_half();
    position_m += Vector3(chord_m * north, chord_m * east, -rates[kVerticalRate]);
    turn_half();
    speed_mps = next_mps;
  }
};

Sampler::Flight Sampler::begin(Random& random, const std::size_t* bins) const {
  Flight flight;
  const auto [low_ft, width_ft] = cut_.altitude_range_ft(bins[*model_.places.altitude_ft]);
  flight.position_m.z() = -kMetresOfFoot * (low_ft + width_ft * random.uniform());
  if (const auto speed = model_.places.speed_kt)
    flight.speed_mps = drawn_value(speeds_[bins[*speed]], random);
  for (std::size_t rate = 0; rate < kRates; ++rate)
    if (const auto variable = rate_variables_[rate])
      flight.set(rate, drawn_value(ranges_[rate][bins[*variable]], random));
  return flight;
}

// The bins of the next second, and new values where a bin changes or is drawn anew within itself.
void Sampler::change(Random& random, std::size_t* bins, Flight& flight) const {
  std::array<std::size_t, kRates> before{};
  for (std::size_t d = 0; d < model_.dynamic.size(); ++d) before[d] = bins[model_.dynamic[d].now];
  step(random, bins);
  for (std::size_t d = 0; d < model_.dynamic.size(); ++d) {
    const DynamicVariable& variable = model_.dynamic[d];
    const std::size_t bin = bins[variable.now];
    const std::size_t rate = rate_of_dynamic_[d];
    if (bin != before[d] || random.uniform() < variable.resample_rate)
      flight.set(rate, drawn_value(ranges_[rate][bin], random));
  }
}

bool Sampler::can_fly(const Flight& flight) const {
  if (flight.position_m.z() > 0) return false;
  if (!model_.places.speed_kt) return true;
  const double highest_mps = speeds_.back()[0] + speeds_.back()[1];
  return flight.speed_mps >= speeds_.front()[0] && flight.speed_mps <= highest_mps &&
         flight.speed_mps > std::abs(flight.rates[kVerticalRate]);
}

bool Sampler::fly(Random& random, std::size_t* bins, track::Track& track) const {
  Flight flight = begin(random, bins);
  for (std::size_t i = 0; i < track.size(); ++i) {
    if (i > 0) {
      flight.advance();
      change(random, bins, flight);
    }
    if (!can_fly(flight)) return false;
    track.positions_ned_m[i] = flight.position_m;
    track.velocities_ned_mps[i] = flight.velocity_mps();
  }
  return true;
}

SampledTrack Sampler::sample(std::uint64_t index) const {
  Random random = Seed(options_.seed).stream("encounter model", index);
  SampledTrack sampled;
  const auto count = static_cast<std::size_t>(options_.duration_s) + 1;
  track::Track& track = sampled.track;
  track.times_s.resize(count);
  for (std::size_t i = 0; i < count; ++i) track.times_s[i] = static_cast<double>(i);
  track.positions_ned_m.resize(count);
  track.velocities_ned_mps.resize(count);
  std::vector<std::size_t> bins(variable_count());
  for (; sampled.draws <= kMaxDraws; ++sampled.draws) {
    if (!draw_initial(random, bins.data())) continue;
    sampled.initial_bins.assign(bins.begin(), bins.begin() + model_.initial.size());
    if (fly(random, bins.data(), track)) return sampled;
  }
  throw Error(fmt::format("none of {} draws of track {} can be flown: their airspeed leaves the "
                          "model's range, or they go below the ground",
                          kMaxDraws,
                          index),
              {model_.file.string()});
}

}  // namespace airtruth::encounter_model
