// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

// What goes into a network and what comes out, and both as bytes for the socket between the program
// and airtruth-network-runner.
namespace airtruth::network {

// Packed samples of 8 bits, row after row, the channels of a pixel beside one another.
struct Samples {
  int width = 0;
  int height = 0;
  int channels = 1;
  std::vector<std::uint8_t> values;  // width * height * channels

  const std::uint8_t* at(int x, int y) const {
    return values.data() + (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                            static_cast<std::size_t>(x)) *
                               static_cast<std::size_t>(channels);
  }
};

Samples make_samples(int width, int height, int channels);  // zeros

// An output of the network: the last dimension varies fastest.
struct Tensor {
  std::vector<int> shape;
  std::vector<float> values;
};

// "1 x 2 x 120 x 160"
std::string in_words(const std::vector<int>& shape);

std::string bytes_of(const std::vector<Tensor>& tensors);
// Throws Error where the bytes are not exactly such tensors.
std::vector<Tensor> tensors_from_bytes(std::string_view bytes);

}  // namespace airtruth::network
