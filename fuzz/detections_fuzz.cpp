// SPDX-License-Identifier: Apache-2.0
// The first byte chooses a reader of detectors' results: COCO results, MOTChallenge text, a folder
// of airtruth's own, the regions of ignore.csv, and what a detector's program may answer. The
// result is detections that a picture can hold, or an Error.
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>

#include <unistd.h>

#include "evaluation/scores/ignored_regions.h"
#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "runners/detector/protocol.h"
#include "runners/results/detections.h"
#include "runners/results/results_folder.h"

namespace {

using namespace airtruth;
using namespace airtruth::detector;
using namespace airtruth::results;

constexpr int kWidth = 640;
constexpr int kHeight = 480;
const std::array<ExpectedSequence, 2> kSet = {{{"a", kWidth, kHeight, 3}, {"b", 0, 0, 2}}};

enum class Kind { kCoco, kMot, kOwnText, kOwnFacts, kIgnored, kHello, kAnswer, kCount };

const fs::path& folder() {
  static const fs::path made = [] {
    return fs::temp_directory_path() / ("airtruth_detections_fuzz_" + std::to_string(::getpid()));
  }();
  return made;
}

void put(const char* file, std::string_view content) {
  write_file(folder() / file, std::string(content), Flush::kLater);
}

void check_results() {
  for (const SequenceDetections& sequence : read_detections(folder(), kSet)) {
    const ExpectedSequence& expected = sequence.name == "a" ? kSet[0] : kSet[1];
    if (std::ssize(sequence.frames) != expected.frames) std::abort();
    for (const std::vector<Detection>& frame : sequence.frames)
      for (const Detection& one : frame)
        if (fault_of(one, expected.width, expected.height)) std::abort();
  }
}

void check_regions() {
  for (const scores::IgnoredRegion& region :
       scores::read_ignored_regions(folder() / "ignore.csv")) {
    const Box& box = region.box_px;
    const bool is_finite = std::isfinite(box.x + box.y + box.width + box.height);
    if (!is_finite || !(box.width > 0 && box.height > 0) || region.first_frame < 0) std::abort();
    if (region.last_frame && *region.last_frame < region.first_frame) std::abort();
  }
}

void check_answer(std::string_view line) {
  const std::vector<Detection> answer = detections_of(line, 7);
  if (answer.size() > kMostInAnAnswer) std::abort();
  for (const Detection& one : answer) {
    const Box& box = one.box_px;
    if (!std::isfinite(box.x) || !std::isfinite(box.y) || !std::isfinite(box.width) ||
        !std::isfinite(box.height) || !std::isfinite(one.score) || one.category.empty() ||
        one.track.value_or(0) < 0)
      std::abort();
  }
}

void read(Kind kind, std::string_view content) {
  switch (kind) {
    case Kind::kCoco:
      put("r.json", content);
      return check_results();
    case Kind::kMot:
      put("a.txt", content);
      return check_results();
    case Kind::kOwnText:
      put("detector.json", "{}");
      put("a.txt", content);
      put("a.json", R"({"format":"airtruth detections 1","width":640,"height":480,"frames":3})");
      return check_results();
    case Kind::kOwnFacts:
      put("detector.json", "{}");
      put("a.txt", "1,-1,1,1,9,9,0.5\n");
      put("a.json", content);
      return check_results();
    case Kind::kIgnored:
      put("ignore.csv", content);
      return check_regions();
    case Kind::kHello:
      hello_of(content);
      return;
    case Kind::kAnswer:
      return check_answer(content);
    case Kind::kCount:
      break;
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string_view content(reinterpret_cast<const char*>(data) + 1, size - 1);
  fs::remove_all(folder());
  fs::create_directories(folder());
  try {
    read(static_cast<Kind>(data[0] % static_cast<int>(Kind::kCount)), content);
  } catch (const Error&) {
  } catch (const process::Failure&) {
  }
  return 0;
}
