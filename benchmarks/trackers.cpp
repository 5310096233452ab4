// SPDX-License-Identifier: Apache-2.0
// How fast each tracker within the program is, by the size of its object: ./dev bench trackers
//
// Frames of 1280 x 960 with soft clouds, noise and a patterned object that moves a few pixels a
// frame; one core; every round runs each tracker once, in turn, so that a slow minute of the
// machine falls on all of them. Printed: median over the rounds of the mean time per answer,
// without loading frames. Markdown.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <vector>

#include <fmt/format.h>
#include <opencv2/core.hpp>
#include <sched.h>

#include "foundation/base/seed.h"
#include "foundation/image/picture.h"
#include "runners/tracking/tracker.h"

namespace {

using namespace airtruth;

constexpr int kWidth = 1280;
constexpr int kHeight = 960;
constexpr int kFrames = 12;
constexpr int kSizes[] = {10, 20, 40, 80, 160};

void use_one_core() {
  cpu_set_t one;
  CPU_ZERO(&one);
  CPU_SET(::sched_getcpu(), &one);
  ::sched_setaffinity(0, sizeof one, &one);
  cv::setNumThreads(1);
}

Box box_at(int frame, int size) {
  return {300.0 + 5 * frame, 250.0 + 3 * frame, double(size), std::max(4.0, size * 0.5)};
}

image::Picture frame_of(int frame, int size) {
  image::Picture picture = image::make_picture(kWidth, kHeight, {});
  Random random(static_cast<std::uint64_t>(frame) + 1);
  const Box box = box_at(frame, size);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      double level = 140 + 40 * std::sin(x / 61.0) * std::cos(y / 43.0) + random.uniform(-3, 3);
      const double u = (x - box.x) / box.width;
      const double v = (y - box.y) / box.height;
      if (u >= 0 && u < 1 && v >= 0 && v < 1) level = 60 + 40 * std::sin(9 * u) * std::sin(5 * v);
      picture.planes[0].row(y)[x] = static_cast<std::uint8_t>(level);
    }
  for (std::size_t p = 1; p < 3; ++p)
    for (int y = 0; y < picture.planes[p].height; ++y)
      std::fill_n(picture.planes[p].row(y), picture.planes[p].width, std::uint8_t{128});
  return picture;
}

// Mean seconds of an answer.
double seconds_of(const std::string& name, int size, const std::vector<image::Picture>& frames) {
  const auto tracker = tracking::make_tracker(name, {});
  tracker->load(frames.front());
  tracker->init(box_at(0, size));
  std::chrono::duration<double> spent{};
  for (std::size_t i = 1; i < frames.size(); ++i) {
    tracker->load(frames[i]);
    const auto start = std::chrono::steady_clock::now();
    tracker->update();
    spent += std::chrono::steady_clock::now() - start;
  }
  return spent.count() / static_cast<double>(frames.size() - 1);
}

}  // namespace

int main(int argc, char** argv) {
  const int rounds = argc > 1 ? std::max(1, std::atoi(argv[1])) : 5;
  use_one_core();
  const std::vector<std::string> names = tracking::tracker_names();
  std::vector<std::vector<double>> medians(names.size());
  for (const int size : kSizes) {
    std::vector<image::Picture> frames;
    for (int i = 0; i < kFrames; ++i) frames.push_back(frame_of(i, size));
    std::vector<std::vector<double>> seconds(names.size());
    for (int round = 0; round < rounds; ++round)
      for (std::size_t k = 0; k < names.size(); ++k)
        seconds[k].push_back(seconds_of(names[k], size, frames));
    for (std::size_t k = 0; k < names.size(); ++k) {
      std::nth_element(seconds[k].begin(), seconds[k].begin() + rounds / 2, seconds[k].end());
      medians[k].push_back(seconds[k][static_cast<std::size_t>(rounds / 2)]);
    }
  }
  fmt::print("Frames/s on one core at {} x {}, by the object's width, median of {} rounds:\n\n",
             kWidth,
             kHeight,
             rounds);
  fmt::print("| tracker |");
  for (const int size : kSizes) fmt::print(" {} px |", size);
  fmt::print("\n|---|");
  for ([[maybe_unused]] const int size : kSizes) fmt::print("---:|");
  for (std::size_t k = 0; k < names.size(); ++k) {
    fmt::print("\n| {} |", names[k]);
    for (const double s : medians[k]) fmt::print(" {:.0f} |", 1 / s);
  }
  fmt::print("\n");
}
