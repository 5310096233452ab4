// SPDX-License-Identifier: Apache-2.0
#include "aircraft/ac_text.h"

#include <algorithm>
#include <cstdlib>
#include <sstream>

#include "base/error.h"
#include "base/files.h"

namespace airtruth::aircraft {
namespace {

constexpr std::size_t kMaxBytes = std::size_t{512} << 20;
constexpr double kLargestCreaseDeg = 60;

// The name in a line such as: texture "a.png"
std::string between_quotes(const std::string& line) {
  const auto open = line.find('"');
  const auto close = line.rfind('"');
  if (open == std::string::npos || close <= open + 1) return "";
  return line.substr(open + 1, close - open - 1);
}

}  // namespace

std::string listed(const std::vector<fs::path>& folders) {
  std::string text;
  for (const fs::path& folder : folders) text += (text.empty() ? "" : ", ") + folder.string();
  return text;
}

fs::path find_texture(const std::string& name, const std::vector<fs::path>& folders) {
  std::string clean = name;
  std::replace(clean.begin(), clean.end(), '\\', '/');
  for (const fs::path& folder : folders) {
    for (const fs::path& candidate : {folder / clean, folder / fs::path(clean).filename()}) {
      std::error_code ignored;
      if (fs::is_regular_file(candidate, ignored)) return fs::absolute(candidate);
    }
  }
  return {};
}

PreparedAc prepared_ac(const fs::path& file) {
  std::istringstream lines(read_file(file, kMaxBytes));
  PreparedAc result;
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (number == 1 && line.rfind("AC3D", 0) != 0)
      throw Error("is no AC3D file (it does not begin with AC3D)", {file.string(), 1});
    if (line.rfind("texture ", 0) == 0) {
      const std::string name = between_quotes(line);
      if (name.empty()) continue;
      result.line_of_texture.emplace(name, number);
    } else if (line.rfind("crease ", 0) == 0 && std::atof(line.c_str() + 7) > kLargestCreaseDeg) {
      line = "crease 60";
    }
    result.text += line;
    result.text += '\n';
  }
  if (number == 0) throw Error("is empty; expected a 3D model", {file.string()});
  return result;
}

}  // namespace airtruth::aircraft
