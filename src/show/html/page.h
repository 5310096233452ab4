// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace airtruth::html {

// A picture that a page's script reads, in base64, from the element with this id.
struct PagePicture {
  std::string id;
  std::string jpeg;
};

// Builds one self-contained HTML page that needs no network: the common style sheet, `body`, `json`
// in the element "data", the pictures but empty ones, Chart.js, the common script
// (assets/common.js) and `script`. `json` is escaped, so that a user's text cannot end its element.
std::string page_of(std::string_view title,
                    std::string_view body,
                    std::string_view json,
                    const std::vector<PagePicture>& pictures,
                    std::string_view script);

// The parts of the pages, embedded into the program at build time: assets/* and Debian's Chart.js
// (package libjs-chart.js, MIT licence).
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
