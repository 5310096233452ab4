// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

// The page of `airtruth studio`, embedded into the program at build time: assets/index.html, and
// its script and style sheet as bundled by esbuild. index.html refers to /studio.js and /studio.css
// of the server that it comes from, and to nothing else.
namespace airtruth::page {

std::string_view index_html();
std::string_view studio_js();
std::string_view studio_css();

}  // namespace airtruth::page
