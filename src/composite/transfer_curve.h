// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <vector>

namespace airtruth::composite {

// sRGB's curve by tables, continued beyond [0, 1]: f(-x) = -f(x), and the same power law above 1.
// Video can hold such values (blacker than black, colours outside of the RGB cube), and they must
// survive a blend unclamped. Within 2e-5 of the exact curve, which is 1/200 of a code value.
class TransferCurve {
 public:
  TransferCurve();
  float linear_from_coded(float coded) const { return odd(decode_, coded); }
  float coded_from_linear(float linear) const {
    return odd(std::abs(linear) <= 1 ? encode_ : encode_bright_, linear);
  }

 private:
  struct Table {
    float scale = 0;  // entries per unit
    std::vector<float> values;
  };
  template <typename Function>
  static Table tabulate(float high, int entries, Function function);

  static float odd(const Table& table, float x) {
    const float place = std::abs(x) * table.scale;
    const auto last = static_cast<float>(table.values.size() - 2);
    const float below = std::floor(place < last ? place : last);
    const auto i = static_cast<std::size_t>(below);
    const float t = place - below;
    return std::copysign(table.values[i] + t * (table.values[i + 1] - table.values[i]), x);
  }

  Table decode_, encode_, encode_bright_;
};

}  // namespace airtruth::composite
