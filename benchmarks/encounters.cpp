// SPDX-License-Identifier: Apache-2.0
// How fast tracks are drawn from an encounter model: ./dev bench encounters MODEL...
//
// One core; tracks of 60 s; every round draws from each model once, in turn. Printed: tracks for a
// second of processor time in the fastest round, and the draws that a track takes. Markdown.
#include <algorithm>
#include <cstdint>
#include <ctime>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "encounter/encounter_model/sampler.h"

namespace {

using namespace airtruth;

constexpr int kRounds = 5;
constexpr std::uint64_t kTracks = 20'000;

double processor_s() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

struct Result {
  double fastest_s = 1e9;
  std::int64_t draws = 0;
};

void measure(const encounter_model::Sampler& sampler, Result& result) {
  const double begin_s = processor_s();
  result.draws = 0;
  for (std::uint64_t i = 0; i < kTracks; ++i) result.draws += sampler.sample(i).draws;
  result.fastest_s = std::min(result.fastest_s, processor_s() - begin_s);
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<encounter_model::Sampler> samplers;
  for (int i = 1; i < argc; ++i)
    samplers.emplace_back(encounter_model::read_model(argv[i]), encounter_model::SampleOptions{});
  std::vector<Result> results(samplers.size());
  for (int round = 0; round < kRounds; ++round)
    for (std::size_t i = 0; i < samplers.size(); ++i) measure(samplers[i], results[i]);
  fmt::print("| model | tracks a second | draws a track |\n|---|---|---|\n");
  for (std::size_t i = 0; i < samplers.size(); ++i)
    fmt::print("| {} | {:.0f} | {:.2f} |\n",
               samplers[i].model().file.filename().string(),
               kTracks / results[i].fastest_s,
               static_cast<double>(results[i].draws) / kTracks);
}
