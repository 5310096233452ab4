// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <string_view>

namespace airtruth::flight_log {

// The number of type T at byte `at`, stored with its lowest byte first. `bytes` must hold it.
template <typename T>
T little_endian(std::string_view bytes, std::size_t at) {
  static_assert(std::endian::native == std::endian::little);
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

}  // namespace airtruth::flight_log
