// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "foundation/image/tone_curve.h"

namespace airtruth::composite {

// A tone curve in tables, continued beyond [0, 1]: f(-x) = -f(x), and the same power law above 1.
// Video can hold such values (blacker than black, colours outside of the RGB cube), and they must
// survive a blend unclamped. The table of sRGB is within 2e-5 of the exact curve, which is 1/200 of
// a code value.
class TransferCurve {
 public:
  explicit TransferCurve(const image::ToneCurve& tone) {
    const auto linear = [&](double coded) { return tone.linear_from_coded(coded); };
    const auto coded = [&](double light) { return tone.coded_from_linear(light); };
    // 8-bit Y'CbCr reaches from -1.3 to 2.3.
    decode_ = tabulate(2.5f, 2560, linear);
    // A higher exponent has a stronger curvature near black.
    encode_ = tabulate(1.0f, tone.gamma == 0 ? 4096 : 65536, coded);
    encode_bright_ = tabulate(10.0f, 2048, coded);
  }

  float linear_from_coded(float coded) const { return odd(decode_, coded); }
  float coded_from_linear(float linear) const {
    return odd(std::abs(linear) <= 1 ? encode_ : encode_bright_, linear);
  }

 private:
  struct Table {
    // Entries per unit.
    float scale = 0;
    std::vector<float> values;
  };
  template <typename Function>
  static Table tabulate(float high, int entries, Function function) {
    Table table;
    table.scale = static_cast<float>(entries) / high;
    for (int i = 0; i <= entries; ++i)
      table.values.push_back(static_cast<float>(function(static_cast<double>(high) * i / entries)));
    return table;
  }

  static float odd(const Table& table, float x) {
    const float place = std::abs(x) * table.scale;
    const auto i = std::min(static_cast<int>(place), static_cast<int>(table.values.size()) - 2);
    const float t = place - static_cast<float>(i);
    const float* value = table.values.data() + i;
    return std::copysign(value[0] + t * (value[1] - value[0]), x);
  }

  Table decode_, encode_, encode_bright_;
};

}  // namespace airtruth::composite
