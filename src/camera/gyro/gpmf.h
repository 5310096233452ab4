// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

// GoPro's telemetry, GPMF: elements of a key, a type, the size of one structure, their count, and
// the values, big-endian and padded to four bytes. Devices (DEVC) hold streams (STRM), and streams
// hold values. Source: GoPro, "GPMF Introduction" (github.com/gopro/gpmf-parser, README).
namespace airtruth::gyro {

struct GpmfElement {
  std::string_view key;
  char type = 0;
  std::size_t size = 0;  // of one structure, in bytes
  std::size_t count = 0;
  std::span<const std::uint8_t> data;
};

// Visits the elements of one level. Stops at the first element that does not fit into `bytes`.
template <typename Visit>
void each_gpmf_element(std::span<const std::uint8_t> bytes, const Visit& visit) {
  // Bytes of an element's key (4), type, size (1 each) and count (2).
  constexpr std::size_t kHead = 8;
  while (bytes.size() >= kHead) {
    GpmfElement e;
    e.key = {reinterpret_cast<const char*>(bytes.data()), 4};
    e.type = static_cast<char>(bytes[4]);
    e.size = bytes[5];
    e.count = static_cast<std::size_t>(bytes[6]) << 8 | bytes[7];
    const std::size_t length = e.size * e.count;
    const std::size_t padded = (length + 3) / 4 * 4;
    if (bytes.size() - kHead < length) return;
    e.data = bytes.subspan(kHead, length);
    visit(e);
    if (bytes.size() - kHead < padded) return;
    bytes = bytes.subspan(kHead + padded);
  }
}

// Visits the elements of each stream of each device of a packet: visit(stream's bytes).
template <typename Visit>
void each_gpmf_stream(std::span<const std::uint8_t> packet, const Visit& visit) {
  each_gpmf_element(packet, [&](const GpmfElement& device) {
    if (device.key != "DEVC") return;
    each_gpmf_element(device.data, [&](const GpmfElement& stream) {
      if (stream.key == "STRM") visit(stream.data);
    });
  });
}

// The unsigned number of `width` bytes at a byte of `data`, which must hold it.
inline std::uint32_t big_endian(std::span<const std::uint8_t> data,
                                std::size_t at,
                                std::size_t width) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < width; ++i) value = value << 8 | data[at + i];
  return value;
}

}  // namespace airtruth::gyro
