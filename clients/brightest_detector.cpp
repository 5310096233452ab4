// SPDX-License-Identifier: Apache-2.0
// A detector that finds the brightest pixel of every frame: what a program of one's own begins
// with.
//
//   airtruth detect DIR --detector "brightest=exec:./brightest_detector" --out results
#include <algorithm>
#include <cstring>

#include "airtruth_detector.hpp"

int main(int argc, char** argv) {
  using namespace airtruth_detector;
  const bool is_shared = argc > 1 && std::strcmp(argv[1], "--shared") == 0;
  Server server(Samples::kGray, is_shared ? Frames::kSharedMemory : Frames::kPipe);
  while (const auto frame = server.wait()) {
    const unsigned char* end = frame->samples + frame->width * frame->height;
    const unsigned char* most = std::max_element(frame->samples, end);
    const auto at = static_cast<int>(most - frame->samples);
    const double x = at % frame->width, y = at / frame->width;
    server.reply({{x - 2, y - 2, 5, 5, *most / 255.0, "aircraft", -1}});
  }
}
