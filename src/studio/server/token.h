// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace airtruth::server {

// 128 bits of the kernel's randomness as 32 hexadecimal digits. Throws Error where it has none.
std::string new_token();

// Takes the same time wherever the texts differ.
bool is_same(std::string_view a, std::string_view b);

}  // namespace airtruth::server
