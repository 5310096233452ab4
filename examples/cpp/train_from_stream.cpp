// SPDX-License-Identifier: Apache-2.0
// Prints the boxes of the first samples of a training stream: train_from_stream CATALOGUE COUNT
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <iostream>

#include <airtruth/stream.h>

int main(int argc, char** argv) {
  if (argc != 3) {
    std::cerr << "usage: train_from_stream CATALOGUE COUNT\n";
    return 2;
  }
  try {
    const airtruth::Stream stream(argv[1]);
    const std::int64_t count = std::strtoll(argv[2], nullptr, 10);
    for (std::int64_t i = 0; i < count; ++i) {
      const airtruth::StreamSample sample = stream.sample(i);
      const airtruth::RenderedFrame& frame = sample.frames.front();
      std::cout << i << ' ' << sample.background << ' ' << sample.first_frame << ' '
                << frame.picture.width << 'x' << frame.picture.height << '\n';
      for (std::size_t k = 0; k < frame.truth.intruders.size(); ++k)
        if (const auto& box = sample.covered.front()[k])
          std::cout << "  " << frame.truth.intruders[k].object_class << ' ' << box->x << ' '
                    << box->y << ' ' << box->width << ' ' << box->height << '\n';
    }
  } catch (const airtruth::Error& error) {
    std::cerr << error.what() << '\n';
    return 2;
  }
}
