// SPDX-License-Identifier: Apache-2.0
#include "calibration/camera_file/quantities.h"

#include <algorithm>
#include <stdexcept>

namespace airtruth::camera_file {

void put(Quantity& quantity, const Measured<Estimate>& measured) {
  if (measured)
    quantity.values = {*measured};
  else
    quantity.missing = measured.why();
}

void put(Quantity& quantity, const Measured<ColourEstimate>& measured) {
  if (measured)
    quantity.values.assign(measured->begin(), measured->end());
  else
    quantity.missing = measured.why();
}
namespace {

const QuantityKey& key_of(std::string_view name) {
  const auto found = std::find_if(kQuantityKeys.begin(),
                                  kQuantityKeys.end(),
                                  [&](const QuantityKey& key) { return key.name == name; });
  if (found == kQuantityKeys.end())
    throw std::out_of_range("no quantity has the key " + std::string(name));
  return *found;
}

}  // namespace

Quantity& Quantities::at(std::string_view key) { return this->*key_of(key).member; }

const Quantity& Quantities::at(std::string_view key) const { return this->*key_of(key).member; }

std::string_view QuantityKey::table() const {
  const std::string_view whole(name);
  return whole.substr(0, whole.find('.'));
}

std::string_view QuantityKey::key() const {
  const std::string_view whole(name);
  return whole.substr(whole.find('.') + 1);
}

}  // namespace airtruth::camera_file
