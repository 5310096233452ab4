// SPDX-License-Identifier: Apache-2.0
// How fast the classical detectors are: ./dev bench detectors VIDEO...
//
// One core (OpenCV's own threads are off). Every detector sees every frame of every video in turn;
// decoding and the measuring of the camera's motion are told apart. Printed: milliseconds of
// processor time for a frame, mean and 95th percentile, and frames a second. Markdown.
#include <algorithm>
#include <ctime>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <malloc.h>
#include <opencv2/core.hpp>

#include "runners/classical/classical.h"
#include "runners/runs/clips.h"

namespace {

using namespace airtruth;

double processor_s() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

double timed_ms(const auto& work) {
  const double begin_s = processor_s();
  work();
  return 1e3 * (processor_s() - begin_s);
}

void print(const std::string& video, const std::string& what, std::vector<double> ms) {
  std::sort(ms.begin(), ms.end());
  double sum = 0;
  for (const double one : ms) sum += one;
  const double mean = sum / static_cast<double>(ms.size());
  fmt::print("| {} | {} | {:.1f} | {:.1f} | {:.0f} |\n",
             video,
             what,
             mean,
             ms[ms.size() * 95 / 100],
             1e3 / mean);
}

void measure(const std::string& video) {
  const runs::DetectionClip clip = runs::clip_of(std::filesystem::path(video));
  runs::ClipFrames frames(clip, true, {});
  std::map<std::string, std::unique_ptr<detector::Detector>> detectors;
  for (const std::string& name : classical::classical_names()) {
    detectors[name] = classical::make_classical(name);
    detectors[name]->begin(frames.sequence());
  }
  std::vector<double> motion_ms;
  std::map<std::string, std::vector<double>> ms;
  std::optional<detector::FrameInput> frame;
  while (true) {
    const double took_ms = timed_ms([&] { frame = frames.next(); });
    if (!frame) break;
    motion_ms.push_back(took_ms);
    for (auto& [name, detector] : detectors)
      ms[name].push_back(timed_ms([&] { detector->detect(*frame); }));
  }
  const std::string label =
      fmt::format("{}, {}x{}", clip.name, frames.sequence().width, frames.sequence().height);
  print(label, "decoding and motion", motion_ms);
  for (const auto& [name, all] : ms) print(label, name, all);
}

}  // namespace

int main(int argc, char** argv) {
  cv::setNumThreads(1);
  // As the program does: memory of frames is kept.
  mallopt(M_MMAP_THRESHOLD, 64 << 20);
  mallopt(M_TRIM_THRESHOLD, 512 << 20);
  fmt::print("| video | | ms a frame | 95 % | frames/s |\n|---|---|---:|---:|---:|\n");
  for (int i = 1; i < argc; ++i) measure(argv[i]);
}
