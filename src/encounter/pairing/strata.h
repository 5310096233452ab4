// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace airtruth::pairing {

// A Latin hypercube (McKay, Beckman and Conover 1979): `count` points in a unit cube. In each
// dimension, each of `count` strata of equal width holds exactly one point. A point follows from
// the seed, the count and its index alone: the permutation of each dimension is a Feistel network
// on the smallest even number of bits that holds the indices; values beyond the last index go
// through it again (Black and Rogaway 2002, "Ciphers with arbitrary finite domains").
class Strata {
 public:
  // The count is at least 1.
  Strata(std::uint64_t seed, std::uint64_t count, std::size_t dimensions);

  // Coordinate of point `index`, from 0 up to but not including 1.
  double at(std::uint64_t index, std::size_t dimension) const;
  // The same, with one offset from the beginning of the stratum for all points (systematic
  // sampling). Of k things of equal width in the unit interval, such points fall into each as often
  // as into the others, within one, and over seeds equally often; points of offsets of their own
  // may differ by two.
  double spaced(std::uint64_t index, std::size_t dimension) const;
  // The stratum of that coordinate, 0 to count - 1.
  std::uint64_t stratum(std::uint64_t index, std::size_t dimension) const;

 private:
  double place_of(std::uint64_t stratum, double within) const;

  // Number of rounds of the Feistel network: a choice.
  static constexpr std::size_t kRounds = 6;

  std::uint64_t seed_;
  std::uint64_t count_;
  double offset_;  // of spaced(), from 0 up to but not including 1
  unsigned half_bits_ = 1;
  std::vector<std::array<std::uint64_t, kRounds>> keys_;
};

}  // namespace airtruth::pairing
