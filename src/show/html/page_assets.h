// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

// The parts of our pages, put into the program when it is built: src/show/html/assets/* and
// Debian's Chart.js (package libjs-chart.js, MIT licence).
namespace airtruth::html {

std::string_view page_css();
std::string_view common_js();
std::string_view page_body();  // of a data set's report
std::string_view page_js();
std::string_view evaluation_body();  // of an evaluation's
std::string_view evaluation_js();
std::string_view chart_js();

}  // namespace airtruth::html
