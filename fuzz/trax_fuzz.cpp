// SPDX-License-Identifier: Apache-2.0
// A line of a tracker's: a message, chatter or a process::Failure; a message goes out and comes
// back the same, and what it says of itself or of its object is read or refused.
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "runners/tracking/trax_message.h"
#include "runners/tracking/trax_tracker.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace airtruth;
  const std::string_view line(reinterpret_cast<const char*>(data), size);
  if (line.find('\n') != std::string_view::npos) return 0;
  try {
    const auto message = tracking::parse_line(line);
    if (!message) return 0;
    const std::string written = tracking::line_of(*message);
    if (tracking::parse_line(std::string_view(written).substr(0, written.size() - 1)) != message)
      std::abort();
    if (message->type == tracking::Type::kHello) tracking::hello_of(*message);
    for (const std::string& argument : message->arguments) {
      const auto box = tracking::box_of(argument);
      if (box && !(box->width > 0 && box->height > 0 && std::isfinite(box->area()))) std::abort();
    }
  } catch (const process::Failure&) {
  }
  return 0;
}
