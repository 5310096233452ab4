// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

// The colours and dashes of series, the same on pages and in figures for a paper.
//
// Example: tracker 0 is a solid blue line, tracker 6 a violet line of long dashes, tracker 12 a
// blue line of short dashes.
namespace airtruth::plot {

using Colour = std::array<std::uint8_t, 3>;  // sRGB

// Black is for the truth alone. The first six colours are distinguishable with every kind of colour
// vision (tests/evaluation_page_test.py measures it); the others come with dashes.
constexpr Colour kTruthColour = {0, 0, 0};
constexpr std::array<Colour, 12> kColours = {{{0, 114, 178},
                                              {230, 159, 0},
                                              {213, 94, 0},
                                              {86, 180, 233},
                                              {170, 51, 119},
                                              {0, 158, 115},
                                              {93, 58, 155},
                                              {140, 86, 75},
                                              {127, 127, 127},
                                              {184, 176, 0},
                                              {244, 166, 200},
                                              {46, 78, 142}}};

// The lengths of a dash and of the gap after it, in the units of each library: pixels in Chart.js,
// line widths in gnuplot. The first is the solid line.
struct Dash {
  int on;
  int off;
};
constexpr std::array<Dash, 3> kDashes = {{{0, 0}, {7, 3}, {2, 3}}};

// The colour and the dash (an index of kDashes) of the series with this number.
Colour colour_of(std::size_t series);
std::size_t dash_of(std::size_t series);

std::string hex(const Colour& colour);  // "#0072b2"

// {"colours": ["#0072b2", ...], "dashes": [[], [7, 3], [2, 3]]} for the script of a page.
std::string styles_json();

}  // namespace airtruth::plot
