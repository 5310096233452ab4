// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace airtruth::html {

// Text, such as pictures in base64, that a page's script reads from the element with this id.
struct PageBlob {
  std::string id;
  std::string text;
};

// Builds one self-contained HTML page that needs no network: the common style sheet, `body`, `json`
// in the element "data", the blobs, Chart.js, the common script (assets/common.js) and `script`.
// `json` is escaped, so that a user's text cannot end its element.
std::string page_of(std::string_view title,
                    std::string_view body,
                    std::string_view json,
                    const std::vector<PageBlob>& blobs,
                    std::string_view script);

}  // namespace airtruth::html
