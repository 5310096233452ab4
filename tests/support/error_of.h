// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "foundation/base/error.h"

namespace airtruth::test_support {

// The words of the Error that the body throws; "no error" where it throws none.
template <typename Body>
std::string error_of(const Body& body) {
  try {
    body();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

}  // namespace airtruth::test_support
