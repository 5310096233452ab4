// SPDX-License-Identifier: Apache-2.0
#include "evaluation/report/tables.h"

#include <cmath>
#include <system_error>

#include "foundation/base/error.h"
#include "foundation/base/files.h"

namespace airtruth::report {

namespace fs = std::filesystem;

std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string result = "\"";
  for (const char c : text) result += c == '"' ? std::string("\"\"") : std::string(1, c);
  return result + "\"";
}

Json json_of(const std::optional<evaluation::Interval>& interval) {
  return interval ? Json{interval->low, interval->high} : Json();
}

Json json_of_bound(double bound) { return std::isfinite(bound) ? Json(bound) : Json(); }

std::string name_of_results(const fs::path& results) {
  const fs::path plain = fs::absolute(results).lexically_normal();
  require_utf8(plain);
  if (fs::is_regular_file(plain)) return plain.stem().string();
  return (plain.has_filename() ? plain : plain.parent_path()).filename().string();
}

void write_files(const fs::path& out, const Files& files) {
  std::error_code failed;
  fs::create_directories(out, failed);
  if (failed) throw Error("cannot create: " + failed.message(), {out.string()});
  for (const auto& [name, text] : files) write_file(out / name, text);
}

}  // namespace airtruth::report
