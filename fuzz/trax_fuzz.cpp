// SPDX-License-Identifier: Apache-2.0
// A line of a tracker's: a message, chatter or a ProtocolError; a message goes out and comes back
// the same, and what it says of itself or of its object is read or refused.
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "benchmark/trax/region.h"
#include "benchmark/trax/session.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace airtruth;
  const std::string_view line(reinterpret_cast<const char*>(data), size);
  if (line.find('\n') != std::string_view::npos) return 0;
  try {
    const auto message = trax::parse_line(line);
    if (!message) return 0;
    const std::string written = trax::line_of(*message);
    if (trax::parse_line(std::string_view(written).substr(0, written.size() - 1)) != message)
      std::abort();
    if (message->type == trax::Type::kHello) trax::hello_of(*message);
    for (const std::string& argument : message->arguments) {
      const auto box = trax::box_of(argument);
      if (box && !(box->width > 0 && box->height > 0 && std::isfinite(box->area()))) std::abort();
    }
  } catch (const trax::ProtocolError&) {
  }
  return 0;
}
