// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "show/plot/plot.h"

// How gnuplot draws the marks of a series: the part of a plot command after the data, which have
// the columns x, y, low and high.
namespace airtruth::plot {

std::string hex(const Colour& c);

// A band about a line.
bool has_band(const Series& series);
// Several such series stand side by side.
bool is_beside_others(const Series& series);
bool has_whiskers(const Series& series);

std::string drawn_as(const Series& series);
// Whiskers are grey on bars, and in the colour of dots.
std::string whiskers_of(const Series& series);
// White below a ring, so that its whisker does not cross it.
std::string white_below_ring();

}  // namespace airtruth::plot
