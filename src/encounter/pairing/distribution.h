// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace airtruth::pairing {

// A distribution that is uniform within each of some bins.
//
//   Distribution({-500, -100, 500}, {1, 3}) has a quarter of its values below -100.
//   Distribution({62}) is always 62.
class Distribution {
 public:
  // `edges` are one number or increasing ones; `shares` are one for each bin, in any unit, and
  // empty for shares in proportion to the bins' widths. Throws Error otherwise, or where a number
  // is not finite, a share is negative or all are 0. `name` is the quantity in messages.
  explicit Distribution(std::vector<double> edges,
                        std::vector<double> shares = {},
                        const std::string& name = "the range");

  // The value below which the share u of the distribution lies; u in [0, 1].
  double quantile(double u) const;
  // 0 outside of the bins. A distribution of one value has no density, and the result is infinite.
  double density(double value) const;
  double low() const { return edges_.front(); }
  double high() const { return edges_.back(); }

 private:
  std::vector<double> edges_;
  // Running sums of the shares, the last of them 1; for one value none.
  std::vector<double> sums_;
};

}  // namespace airtruth::pairing
