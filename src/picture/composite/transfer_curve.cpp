// SPDX-License-Identifier: Apache-2.0
#include "picture/composite/transfer_curve.h"

namespace airtruth::composite {
template <typename Function>
TransferCurve::Table TransferCurve::tabulate(float high, int entries, Function function) {
  Table table;
  table.scale = static_cast<float>(entries) / high;
  for (int i = 0; i <= entries; ++i)
    table.values.push_back(static_cast<float>(function(static_cast<double>(high) * i / entries)));
  return table;
}

TransferCurve::TransferCurve(const image::ToneCurve& tone) {
  const auto linear = [&](double coded) { return tone.linear_from_coded(coded); };
  const auto coded = [&](double light) { return tone.coded_from_linear(light); };
  // 8-bit Y'CbCr reaches from -1.3 to 2.3.
  decode_ = tabulate(2.5f, 2560, linear);
  // A higher exponent has a stronger curvature near black.
  encode_ = tabulate(1.0f, tone.gamma == 0 ? 4096 : 65536, coded);
  encode_bright_ = tabulate(10.0f, 2048, coded);
}

}  // namespace airtruth::composite
