// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "foundation/base/error.h"

namespace airtruth {

// A number of frames or sequences in a record: whole, 0 to 2^53. Error with the file for what is
// none; get<int64_t>() would cut it to the type's width. Json is one of nlohmann's.
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
