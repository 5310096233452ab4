// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <airtruth/calibration.h>

// What a measurement returns: a value with its standard error, or the reason why the clip does not
// show it. A measurement that is not possible is never an error.
//
// Example: a clip of still pictures has no motion blur, so
//
//   const Measured<Estimate> share = blur.share();
//   share            -> false
//   share.why()      -> "too few frames in fast motion have a neighbour at rest"
//
// and of a clip that shows it, *share is {0.5, 0.02}: half of the frame interval, +- 2 % of it.
namespace airtruth::measured {

// One estimate per channel: red, green, blue of linear light.
using ColourEstimate = std::array<Estimate, 3>;

// The reason why a quantity is not measured, as part of a sentence for the user.
struct NotMeasured {
  std::string why;
};

// A `Value`, or the reason why there is none. Reading the value of one without is undefined.
template <typename Value>
class Measured : public std::optional<Value> {
 public:
  Measured(Value value) : std::optional<Value>(std::move(value)) {}
  Measured(NotMeasured reason) : why_(std::move(reason.why)) {}
  // Empty if there is a value.
  const std::string& why() const { return why_; }

 private:
  std::string why_;
};

// A value that a quantity may have, and the logarithm of its likelihood; any constant may be added.
struct Likely {
  double value = 0, log_likelihood = 0;
};
// The mean of at least one such value, each weighted by its likelihood, and the spread about it.
inline Estimate mean_of(const std::vector<Likely>& all) {
  const double best = std::ranges::max(all, {}, &Likely::log_likelihood).log_likelihood;
  double total = 0, sum = 0, squares = 0;
  for (const Likely& one : all) {
    const double likelihood = std::exp(one.log_likelihood - best);
    total += likelihood, sum += likelihood * one.value;
    squares += likelihood * one.value * one.value;
  }
  const double mean = sum / total;
  return {mean, std::sqrt(std::max(0.0, squares / total - mean * mean))};
}

}  // namespace airtruth::measured
