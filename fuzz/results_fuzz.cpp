// SPDX-License-Identifier: Apache-2.0
// The first byte chooses a kind of result file, the rest is its content: runs over the clip's
// frames, with boxes that have an area, or an Error.
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>

#include <unistd.h>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "runners/results/trajectories.h"

namespace {

using namespace airtruth;
namespace fs = std::filesystem;

struct Case {
  const char* file;
  const char* times;  // beside it, of the same content
};
constexpr std::array<Case, 7> kCases = {{
    {"a.txt", nullptr},
    {"a/a_001.txt", nullptr},
    {"restart/a/a_001.txt", nullptr},
    {"multistart/a/a_00000001.txt", nullptr},
    {"baseline/a/a_001.bin", nullptr},
    {"baseline/a/a_00000001.bin", nullptr},
    {"a.txt", "a_time.txt"},
}};

const fs::path& folder() {
  static const fs::path made = [] {
    return fs::temp_directory_path() / ("airtruth_results_fuzz_" + std::to_string(::getpid()));
  }();
  return made;
}

// Three frames with one object.
exchange::Clip clip() {
  exchange::Clip clip;
  clip.name = "a";
  clip.width = 640, clip.height = 480;
  for (const std::int64_t frame : {0, 1, 2}) {
    exchange::Label label;
    label.category = "aircraft";
    label.box_px = {10.0 + double(frame), 20, 30, 15};
    clip.frames.push_back({frame, {}, {label}});
  }
  return clip;
}

void check(const results::TrackerResults::Run& run) {
  if (!run.seconds.empty() && run.seconds.size() != run.frames.size()) std::abort();
  for (const evaluation::VotFrame& frame : run.frames)
    if (frame.box && !(frame.box->width > 0 && frame.box->height > 0 &&
                       std::isfinite(frame.box->x + frame.box->y + frame.box->area())))
      std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const Case& one = kCases[data[0] % kCases.size()];
  const std::string_view content(reinterpret_cast<const char*>(data) + 1, size - 1);
  fs::remove_all(folder());
  fs::create_directories((folder() / one.file).parent_path());
  const bool has_times = one.times != nullptr;
  write_file(
      folder() / one.file, has_times ? "1,2,3,4\n1,2,3,4\n1,2,3,4\n" : content, Flush::kLater);
  if (has_times) write_file(folder() / one.times, content, Flush::kLater);
  const exchange::Clip truth = clip();
  results::TrackerResults results;
  try {
    results = results::read_results(folder(), truth, data[0] & 128 ? 1 : 0);
  } catch (const Error&) {
    return 0;
  }
  for (const auto* runs : {&results.one_pass, &results.restart, &results.multistart})
    for (const results::TrackerResults::Run& run : *runs) check(run);
  for (const auto* runs : {&results.one_pass, &results.restart})
    for (const results::TrackerResults::Run& run : *runs)
      if (run.frames.size() != truth.frames.size()) std::abort();
  return 0;
}
