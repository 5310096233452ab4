// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string_view>

namespace airtruth {

// A small fast generator whose values are the same on every machine (Steele, Lea and Flood 2014,
// SplitMix64). Satisfies UniformRandomBitGenerator; prefer uniform() and normal(), since the
// standard library's distributions differ between implementations.
class Random {
 public:
  using result_type = std::uint64_t;
  explicit Random(std::uint64_t state) : state_(state) {}

  static constexpr result_type min() { return 0; }
  static constexpr result_type max() { return ~result_type{0}; }
  result_type operator()();

  double uniform();                         // in [0, 1)
  double uniform(double low, double high);  // in [low, high)
  double normal();                          // mean 0, standard deviation 1 (Box and Muller 1958)

 private:
  std::uint64_t state_;
};

// The seed of a scene. Each use of randomness draws from its own named stream, so that adding one
// never changes another: Seed(1).stream("wind").
class Seed {
 public:
  explicit Seed(std::uint64_t value) : value_(value) {}
  Random stream(std::string_view name) const;
  // A stream for one item of a series, for example one frame: the same whatever the order of the
  // frames.
  Random stream(std::string_view name, std::uint64_t index) const;

 private:
  std::uint64_t value_;
};

}  // namespace airtruth
