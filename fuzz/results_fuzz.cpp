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

void check(const evaluation::Trajectory& run) {
  for (const evaluation::VotFrame& frame : run)
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
  for (const evaluation::AnchorRun& run : results.multistart) check(run.frames);
  std::vector<evaluation::Trajectory> whole = results.restart;
  if (results.one_pass) {
    if (results.one_pass->seconds.size() != results.one_pass->frames.size()) std::abort();
    whole.push_back(results.one_pass->frames);
  }
  for (const evaluation::Trajectory& run : whole) {
    check(run);
    if (run.size() != truth.frames.size()) std::abort();
  }
  return 0;
}
