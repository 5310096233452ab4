// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace airtruth {

// RFC 4648, with padding.
std::string base64_of(std::string_view bytes);

}  // namespace airtruth
