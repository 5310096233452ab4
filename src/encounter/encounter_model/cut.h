// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "encounter/encounter_model/model_file.h"
#include "foundation/base/seed.h"

// The part of a model's traffic that a user wants.
namespace airtruth::encounter_model {

// Each limit is off where it is empty.
struct Cut {
  // Numbers of bins, from 1 as in the publications of the model.
  std::vector<std::size_t> domains;
  std::vector<std::size_t> airspaces;
  // Lowest and highest altitude at the start, in feet above ground.
  std::optional<std::array<double, 2>> altitude_ft;

  bool is_off() const { return domains.empty() && airspaces.empty() && !altitude_ft; }
};

// The distribution of the initial variables that a cut concerns, and of all that they depend on,
// given the cut. The joint probabilities of their bins are summed one by one, so that a rare cut
// costs no more draws than a common one.
class CutTable {
 public:
  // Throws Error where the model lacks a variable of the cut, a bin has a number that the model
  // does not have, the range of altitudes is empty, the model has no traffic in the cut, or the cut
  // depends on more than a million combinations of bins.
  CutTable(const BayesModel& model, const Cut& cut);

  // Share of the model's traffic that is in the cut, 0..1.
  double share() const { return share_; }
  // Variables that draw() sets.
  const std::vector<std::size_t>& variables() const { return variables_; }
  // Draws the bins of those variables.
  void draw(Random& random, std::size_t* bins) const;
  // Lowest altitude and width of the range of altitudes of a bin, in feet.
  std::array<double, 2> altitude_range_ft(std::size_t bin) const { return altitudes_ft_[bin]; }

 private:
  void set_altitudes(const BayesModel& model, const Cut& cut);
  void set_table(const BayesModel& model, const std::vector<std::vector<double>>& kept);

  std::vector<std::size_t> variables_;
  // The bins of variables_ for each combination, one after the other, and the running sums of
  // their probabilities.
  std::vector<std::size_t> combinations_;
  std::vector<double> sums_;
  double share_ = 1;
  std::vector<std::array<double, 2>> altitudes_ft_;
};

// The column of a node's table for the bins of all variables.
inline std::size_t column_of(const Node& node,
                             const std::vector<std::size_t>& bins_of_variable,
                             const std::size_t* bins) {
  std::size_t column = 0;
  for (std::size_t i = node.parents.size(); i-- > 0;)
    column = column * bins_of_variable[node.parents[i]] + bins[node.parents[i]];
  return column;
}

}  // namespace airtruth::encounter_model
