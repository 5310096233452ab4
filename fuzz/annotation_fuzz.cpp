// SPDX-License-Identifier: Apache-2.0
// Any bytes are an annotation or an Error; what was read is written and reads back the same.
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "foundation/base/error.h"
#include "labels/annotation/evision.h"
#include "labels/annotation/truth.h"

namespace {

using namespace airtruth::annotation;

void try_evision(std::string_view text) {
  Evision evision;
  try {
    evision = parse_evision(text, "fuzz.xml");
  } catch (const airtruth::Error&) {
    return;
  }
  const std::string written = evision_xml(evision.frames, evision.camera_ned_m);
  const Evision again = parse_evision(written, "again.xml");
  if (evision_xml(again.frames, again.camera_ned_m) != written) std::abort();
}

void try_truth(std::string_view text) {
  Frame frame;
  try {
    frame = parse_jsonl_line(text, "fuzz.jsonl", 1);
  } catch (const airtruth::Error&) {
    return;
  }
  const LensFacts lens{"pinhole", {480, 480}, {640, 480}, {}, 1280, 960};
  const std::string written = jsonl_line(frame, lens);
  if (jsonl_line(parse_jsonl_line(written, "again.jsonl", 1), lens) != written) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  if (text.starts_with('{'))
    try_truth(text);
  else
    try_evision(text);
  return 0;
}
