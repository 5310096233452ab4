// SPDX-License-Identifier: Apache-2.0
// Measures a training stream: `stream_bench CATALOGUE [SAMPLES]` prints the time to the first
// sample, then samples a second of wall-clock time and of CPU time, on one thread, and memory.
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <fstream>
#include <string>

#include <airtruth/stream.h>
#include <fmt/format.h>
#include <unistd.h>

namespace {

double wall_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}
double cpu_s() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }
long resident_mb() {
  std::ifstream statm("/proc/self/statm");
  long all = 0;
  long resident = 0;
  statm >> all >> resident;
  return resident * sysconf(_SC_PAGESIZE) / 1'000'000;
}

void measure(const std::string& catalogue, std::int64_t samples) {
  const double begin_s = wall_s();
  airtruth::StreamOptions options;
  options.seed = 7;
  const airtruth::Stream stream(catalogue, options);
  stream.sample(0);
  fmt::print("first sample after {:.3f} s\n", wall_s() - begin_s);
  // Models, calibrations and clips are open after as many samples as two turns of all lanes take.
  std::int64_t next = 1;
  for (; next < 128; ++next) stream.sample(next);
  fmt::print("samples 1 to 127: {:.1f} a second; {} MB of memory\n",
             127 / (wall_s() - begin_s),
             resident_mb());
  std::int64_t objects = 0;
  const double wall_before_s = wall_s();
  const double cpu_before_s = cpu_s();
  for (std::int64_t i = 0; i < samples; ++i, ++next) {
    const airtruth::StreamSample sample = stream.sample(next);
    for (const auto& intruder : sample.frames.front().truth.intruders)
      objects += intruder.state == airtruth::IntruderState::kVisible ? 1 : 0;
  }
  const auto n = static_cast<double>(samples);
  fmt::print(
      "then {} samples with {} visible objects: {:.1f} a second, {:.1f} a CPU second, "
      "{} MB of memory\n",
      samples,
      objects,
      n / (wall_s() - wall_before_s),
      n / (cpu_s() - cpu_before_s),
      resident_mb());
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2 || argc > 3) {
    fmt::print(stderr, "usage: stream_bench CATALOGUE [SAMPLES]\n");
    return 2;
  }
  try {
    measure(argv[1], argc > 2 ? std::strtoll(argv[2], nullptr, 10) : 2000);
  } catch (const std::exception& error) {
    fmt::print(stderr, "stream_bench: {}\n", error.what());
    return 1;
  }
}
