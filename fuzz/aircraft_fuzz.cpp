// SPDX-License-Identifier: Apache-2.0
// FlightGear's wrapper XML: anything but an Error is a finding.
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "aircraft/wrapper/wrapper.h"
#include "foundation/base/error.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  try {
    (void)airtruth::wrapper::parse_wrapper(text, "a.xml");
  } catch (const airtruth::Error&) {
  }
  return 0;
}
