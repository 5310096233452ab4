// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

// The parts of the HTML pages, embedded into the program at build time: src/show/html/assets/* and
// Debian's Chart.js (package libjs-chart.js, MIT licence).
namespace airtruth::html {

std::string_view page_css();
std::string_view common_js();
// Of a data set's report.
std::string_view page_body();
std::string_view page_js();
std::string_view encounters_js();
// Of an evaluation.
std::string_view evaluation_body();
std::string_view evaluation_js();
// Of an evaluation of detectors; the player's script comes before the page's.
std::string_view detection_body();
std::string_view detection_player_js();
std::string_view detection_js();
std::string_view chart_js();

}  // namespace airtruth::html
