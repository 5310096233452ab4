// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace airtruth::html {

// Text that a page's script takes from the element with this id: pictures in base64.
struct PageBlob {
  std::string id;
  std::string text;
};

// One self-contained HTML page that needs no network: our style, `body`, `json` in the element
// "data", the blobs, Chart.js, what our pages have in common (page/common.js) and `script`. No text
// of a user's in `json` can end its element.
std::string page_of(std::string_view title,
                    std::string_view body,
                    std::string_view json,
                    const std::vector<PageBlob>& blobs,
                    std::string_view script);

}  // namespace airtruth::html
