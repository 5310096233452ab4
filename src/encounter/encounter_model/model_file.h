// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "foundation/base/files.h"

// An airspace encounter model of MIT Lincoln Laboratory: a dynamic Bayesian network that describes
// how aircraft fly. The initial network gives the bins of all variables at time 0; the transition
// network gives the bins of the variables that change, one second later. Source of the model:
// Kochenderfer, Edwards, Espindle, Kuchar and Griffith (2010), "Airspace encounter models for
// estimating collision risk"; of the file: the text files of em-model-manned-bayes
// (docs/formats/encounters.md).
namespace airtruth::encounter_model {

// A variable of a network with the distribution of its bins given those of its parents.
struct Node {
  std::size_t bins = 0;
  // Indices of the parents, in ascending order. Their bins b_0, b_1, ... (from 0) select column
  // b_0 + bins_0 * (b_1 + bins_1 * (...)).
  std::vector<std::size_t> parents;
  // For each column the running sums of the counts of its bins: bin k of column j has the
  // probability (sums[j * bins + k] - sums[j * bins + k - 1]) / sums[j * bins + bins - 1]. A column
  // whose last sum is 0 has no data.
  std::vector<double> sums;

  std::size_t columns() const { return sums.size() / bins; }
  double total(std::size_t column) const { return sums[column * bins + bins - 1]; }
};

// A variable that changes: its index, that of its value one second later, and how often it is
// drawn anew within its bin.
struct DynamicVariable {
  std::size_t now = 0;
  std::size_t next = 0;
  // Probability in each second, 0..1.
  double resample_rate = 0;
};

// Where the variables of known meaning stand among the initial ones; empty where a model lacks one.
struct VariablePlaces {
  std::optional<std::size_t> domain;                // "G", geographic
  std::optional<std::size_t> airspace;              // "A", airspace class
  std::optional<std::size_t> altitude_ft;           // "L", above ground
  std::optional<std::size_t> speed_kt;              // "v", true airspeed
  std::optional<std::size_t> acceleration_ktps;     // "\dot v"
  std::optional<std::size_t> vertical_rate_ftpmin;  // "\dot h", positive upwards
  std::optional<std::size_t> turn_rate_dps;         // "\dot \psi", positive to the right
};

struct BayesModel {
  // Of the initial variables, without quotes.
  std::vector<std::string> labels;
  // The initial variables; the parents are initial variables.
  std::vector<Node> initial;
  // The same for the new variables of the transition network: number i is variable
  // labels.size() + i, and parents are initial or new variables.
  std::vector<Node> transition;
  // Orders in which every variable comes after its parents. They hold indices of `initial` and of
  // `transition`.
  std::vector<std::size_t> initial_order;
  std::vector<std::size_t> transition_order;
  std::vector<DynamicVariable> dynamic;
  // For each initial variable the edges of its bins, one more than bins; empty where the value of
  // the variable is the number of its bin.
  std::vector<std::vector<double>> edges;
  VariablePlaces places;
  fs::path file;
};

// Reads a model. Throws Error with file and line where the file is larger than 64 MiB, a field is
// missing, twice there or unknown, a number is missing, superfluous, not finite, negative or out of
// range, a graph has a cycle, a table has the wrong number of counts, edges do not increase, or a
// variable at (t) lacks its partner at (t+1).
BayesModel read_model(const fs::path& file);
BayesModel parse_model(std::string_view text, const fs::path& file);

}  // namespace airtruth::encounter_model
