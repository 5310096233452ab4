// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "foundation/base/error.h"

namespace airtruth {

// A number of frames or sequences in a record: a whole number from 0 to 2^53. Throws Error with the
// file for any other value, which get<int64_t>() would truncate. Json is a type of nlohmann::json.
template <typename Json>
std::int64_t count_in(const Json& record, const char* key, const std::filesystem::path& file) {
  constexpr std::int64_t kLargestCount = std::int64_t{1} << 53;
  const Json& value = record.at(key);
  if (!value.is_number_integer() || value < 0 || value > kLargestCount)
    throw Error(
        std::string(key) + " is " + value.dump().substr(0, 40) + "; expected a whole number from 0",
        {file.string()});
  return value.template get<std::int64_t>();
}

}  // namespace airtruth
