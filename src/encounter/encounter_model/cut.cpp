// SPDX-License-Identifier: Apache-2.0
#include "encounter/encounter_model/cut.h"

#include <algorithm>
#include <string>

#include <fmt/format.h>

#include "foundation/base/error.h"

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

// How many combinations the bins of the variables have.
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
  std::vector<std::size_t> bins_of;
  for (const Node& node : model.initial) bins_of.push_back(node.bins);
  const std::size_t count = combinations_of(model, variables_);
  std::vector<std::size_t> bins(model.initial.size(), 0);
  double sum = 0;
  for (std::size_t c = 0; c < count; ++c) {
    std::size_t rest = c;
    for (const std::size_t variable : variables_) {
      bins[variable] = rest % bins_of[variable];
      rest /= bins_of[variable];
    }
    double probability = 1;
    for (const std::size_t variable : variables_) {
      const std::size_t column = column_of(model.initial[variable], bins_of, bins.data());
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

}  // namespace airtruth::encounter_model
