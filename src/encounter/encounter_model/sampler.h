// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "encounter/encounter_model/model_file.h"
#include "encounter/track/track.h"
#include "foundation/base/seed.h"

// Tracks drawn from an encounter model, or from the part of its traffic that a user wants.
namespace airtruth::encounter_model {

// The part of a model's traffic that a user wants. Each limit is off where it is empty.
struct Cut {
  // Numbers of bins, from 1 as in the publications of the model.
  std::vector<std::size_t> domains;
  std::vector<std::size_t> airspaces;
  // Lowest and highest altitude at the start, in feet above ground.
  std::optional<std::array<double, 2>> altitude_ft;
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

struct SampleOptions {
  std::uint64_t seed = 1;
  // Length of each track in whole seconds, 1 to kMaxDuration_s.
  int duration_s = 60;
  Cut cut;
};

// The models describe a few minutes of flight.
constexpr int kMaxDuration_s = 3600;

struct SampledTrack {
  // A sample for each second from 0 on. The track begins above the origin and heads north.
  track::Track track;
  // Bins of the initial variables, from 0.
  std::vector<std::size_t> initial_bins;
  // How many draws it took: this one, and those before it that cannot be flown.
  int draws = 1;
};

// Draws tracks from a model. Track i depends on the model, the options and i alone, so that any
// number of threads may draw any of them in any order.
//
// A track is drawn as the publications of the model state it: the initial network in the order of
// its graph; each second the transition network, whose columns follow the bins of that second; a
// value uniformly within its bin when the bin changes, and anew with the variable's resample rate
// in each second. A bin that straddles 0 yields exactly 0, and a column without counts keeps the
// bin. The aircraft flies an arc in each second, at its true airspeed, without wind. A draw whose
// airspeed leaves the model's bins or does not exceed its vertical rate, or that goes below the
// ground, is drawn again.
class Sampler {
 public:
  // Throws Error where the duration is out of range, the cut does not fit the model, or the model
  // changes other variables than acceleration, vertical rate and turn rate.
  Sampler(BayesModel model, const SampleOptions& options);

  // Throws Error where none of many draws can be flown.
  SampledTrack sample(std::uint64_t index) const;
  int duration_s() const { return options_.duration_s; }
  // Share of the model's traffic that is in the cut, 0..1.
  double share() const { return cut_.share(); }

  // The networks alone, without a flight. `bins` holds one bin for each initial variable, then one
  // for each new variable of the transition network. draw_initial() sets the former; false where it
  // meets a column without counts. step() sets the latter from the former, then copies them to the
  // variables that they follow.
  std::size_t variable_count() const { return bins_of_.size(); }
  bool draw_initial(Random& random, std::size_t* bins) const;
  void step(Random& random, std::size_t* bins) const;

  const BayesModel& model() const { return model_; }

 private:
  // Lower edge and width of each bin of a variable, in SI; the width is 0 where the value is 0.
  using Range = std::array<double, 2>;
  // The values that change during a flight, as indices of `ranges_` and of a flight's values.
  enum { kAcceleration, kVerticalRate, kTurnRate, kRates };
  struct Flight;
  Flight begin(Random& random, const std::size_t* bins) const;
  void change(Random& random, std::size_t* bins, Flight& flight) const;
  bool can_fly(const Flight& flight) const;
  bool fly(Random& random, std::size_t* bins, track::Track& track) const;

  BayesModel model_;
  SampleOptions options_;
  CutTable cut_;
  std::vector<std::size_t> bins_of_;
  std::vector<bool> is_cut_;
  std::vector<Range> speeds_;
  std::array<std::optional<std::size_t>, kRates> rate_variables_;
  std::array<std::vector<Range>, kRates> ranges_;
  // For each dynamic variable of the model its place in `ranges_`.
  std::vector<std::size_t> rate_of_dynamic_;
};

}  // namespace airtruth::encounter_model
