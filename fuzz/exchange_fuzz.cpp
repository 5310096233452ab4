// SPDX-License-Identifier: Apache-2.0
// The first byte chooses a format, the rest is its file: clips or an Error, and clips are written
// and read back as labels of our own.
#include <array>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include <unistd.h>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "labels/exchange/exchange.h"

namespace {

using namespace airtruth::exchange;
namespace fs = std::filesystem;

struct Case {
  Format format;
  const char* file;  // in the folder that is read
};
constexpr std::array<Case, 12> kCases = {{
    {Format::kCoco, "annotations/instances_x.json"},
    {Format::kAot, "ImageSets/groundtruth.json"},
    {Format::kVoc, "Annotations/a_000001.xml"},
    {Format::kCvat, "annotations.xml"},
    {Format::kMot, "gt/gt.txt"},
    {Format::kYolo, "labels/a_000001.txt"},
    {Format::kOtb, "groundtruth_rect.txt"},
    {Format::kGot10k, "groundtruth.txt"},
    {Format::kVot, "groundtruth.txt"},
    {Format::kCsv, "a.csv"},
    {Format::kYolo, "data.yaml"},
    {Format::kWebdataset, "a.tar"},
}};

const fs::path& folder() {
  static const fs::path made = [] {
    return fs::temp_directory_path() / ("airtruth_exchange_fuzz_" + std::to_string(::getpid()));
  }();
  return made;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const Case& one = kCases[data[0] % kCases.size()];
  fs::remove_all(folder());
  const fs::path file = folder() / one.file;
  fs::create_directories(file.parent_path());
  fs::create_directories(folder() / "labels");
  airtruth::write_file(
      file, {reinterpret_cast<const char*>(data) + 1, size - 1}, airtruth::Flush::kLater);
  std::vector<Clip> clips;
  try {
    clips = read_clips(one.format, folder(), {{{640, 480}}, "aircraft"}, {});
  } catch (const airtruth::Error&) {
    return 0;
  }
  for (const Clip& clip : clips) {
    if (clip.frames.size() > 1000) continue;  // a number in a file makes millions of empty ones
    const fs::path again = folder() / "labels.jsonl";
    airtruth::write_file(again, labels_jsonl(clip), airtruth::Flush::kLater);
    if (read_labels(again).frames.size() != clip.frames.size()) std::abort();
  }
  return 0;
}
