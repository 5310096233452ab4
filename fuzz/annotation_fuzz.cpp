// SPDX-License-Identifier: Apache-2.0
// Any bytes are an annotation or an Error; what was read is written and reads back the same.
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <string_view>

#include <unistd.h>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "labels/annotation/evision.h"
#include "labels/annotation/truth.h"

namespace {

using namespace airtruth::annotation;

std::string written_again(const Evision& evision) {
  static const std::filesystem::path file =
      std::filesystem::temp_directory_path() /
      ("airtruth_annotation_fuzz_" + std::to_string(::getpid()));
  EvisionWriter writer(file);
  for (std::size_t i = 0; i < evision.frames.size(); ++i)
    writer.add(evision.frames[i], evision.camera_ned_m[i]);
  writer.finish();
  return airtruth::read_file(file);
}

void try_evision(std::string_view text) {
  Evision evision;
  try {
    evision = parse_evision(text, "fuzz.xml");
  } catch (const airtruth::Error&) {
    return;
  }
  const std::string written = written_again(evision);
  const Evision again = parse_evision(written, "again.xml");
  if (written_again(again) != written) std::abort();
}

void try_truth(std::string_view text) {
  Frame frame;
  try {
    frame = parse_jsonl_line(text, "fuzz.jsonl", 1);
  } catch (const airtruth::Error&) {
    return;
  }
  const airtruth::lens::Facts lens{"pinhole", {480, 480}, {640, 480}, {}, 1280, 960};
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
