// SPDX-License-Identifier: Apache-2.0
#include "aircraft/fleet/left_out.h"

#include <sstream>

#include "foundation/base/error.h"

namespace airtruth::aircraft {
namespace {

std::map<std::string, std::string> read_rows(std::string_view text) {
  std::map<std::string, std::string> rows;
  std::istringstream lines{std::string(text)};
  std::string line;
  std::getline(lines, line);  // the heading
  while (std::getline(lines, line)) {
    if (line.empty()) continue;
    const auto comma = line.find(',');
    check(comma != std::string::npos, "a row of what is left out has a name and a reason");
    rows[line.substr(0, comma)] = line.substr(comma + 1);
  }
  return rows;
}

}  // namespace

const std::map<std::string, std::string>& left_out() {
  static const std::map<std::string, std::string> rows = read_rows(left_out_table());
  return rows;
}

}  // namespace airtruth::aircraft
