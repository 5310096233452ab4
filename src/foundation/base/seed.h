// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string_view>

namespace airtruth {

// The finaliser of SplitMix64.
constexpr std::uint64_t mixed(std::uint64_t z) {
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  return z ^ (z >> 31);
}

// SplitMix64 (Steele, Lea and Flood 2014): a small, fast generator of 64-bit numbers whose values
// are the same on every machine. It satisfies UniformRandomBitGenerator, but uniform() and normal()
// should be preferred, since the distributions of the standard library differ between
// implementations.
class Random {
 public:
  using result_type = std::uint64_t;
  explicit Random(std::uint64_t state) : state_(state) {}

  static constexpr result_type min() { return 0; }
  static constexpr result_type max() { return ~result_type{0}; }
  result_type operator()() { return mixed(state_ += 0x9e3779b97f4a7c15ULL); }

  double uniform();                         // in [0, 1)
  double uniform(double low, double high);  // in [low, high)
  double normal();                          // mean 0, standard deviation 1 (Box and Muller 1958)

 private:
  std::uint64_t state_;
};

// The seed of a scene. Each use of randomness draws from a stream with its own name, so that adding
// a use does not change the others.
//
//   Random wind = Seed(1).stream("wind");
//   Random noise = Seed(1).stream("noise", 42);  // of frame 42
class Seed {
 public:
  explicit Seed(std::uint64_t value) : value_(value) {}
  Random stream(std::string_view name) const;
  // The stream of one item of a series, for example one frame. It depends on the seed, the name and
  // the index only, so that frames may be processed in any order.
  Random stream(std::string_view name, std::uint64_t index) const;

 private:
  std::uint64_t value_;
};

}  // namespace airtruth
