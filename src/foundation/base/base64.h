// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace airtruth {

// The base64 text of bytes, with padding (RFC 4648).
std::string base64_of(std::string_view bytes);

}  // namespace airtruth
