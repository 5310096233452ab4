// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

// The memory of planes. What one plane gives back, the next of that size takes, whichever threads
// the two belong to: malloc() keeps memory for each thread by itself, so that a run would come to
// hold several times what its frames in flight need (docs/optimisations.md).
namespace airtruth::image {

class GiveBack {
 public:
  GiveBack() = default;
  explicit GiveBack(std::size_t bytes) : bytes_(bytes) {}
  void operator()(std::uint8_t* samples) noexcept;

 private:
  std::size_t bytes_ = 0;
};
using SampleMemory = std::unique_ptr<std::uint8_t[], GiveBack>;

// Not initialised; aligned for any vector.
SampleMemory take_samples(std::size_t bytes);

// What is kept free for planes to come, in bytes.
std::size_t free_sample_bytes();

}  // namespace airtruth::image
