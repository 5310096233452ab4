// SPDX-License-Identifier: Apache-2.0
#include "composite/transfer_curve.h"

namespace airtruth::composite {
namespace {

double exact_linear(double coded) {
  return coded <= 0.04045 ? coded / 12.92 : std::pow((coded + 0.055) / 1.055, 2.4);
}

double exact_coded(double linear) {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

}  // namespace

template <typename Function>
TransferCurve::Table TransferCurve::tabulate(float high, int entries, Function function) {
  Table table;
  table.scale = static_cast<float>(entries) / high;
  for (int i = 0; i <= entries; ++i)
    table.values.push_back(static_cast<float>(function(static_cast<double>(high) * i / entries)));
  return table;
}

TransferCurve::TransferCurve()
    : decode_(tabulate(2.5f, 2560, exact_linear)),  // 8-bit Y'CbCr reaches from -1.3 to 2.3
      encode_(tabulate(1.0f, 4096, exact_coded)),
      encode_bright_(tabulate(10.0f, 2048, exact_coded)) {}

}  // namespace airtruth::composite
