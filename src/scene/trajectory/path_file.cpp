// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/base/names.h"
#include "foundation/base/text.h"
#include "scene/trajectory/path.h"

namespace airtruth::trajectory {
namespace {

// Largest file that is read: it bounds memory.
constexpr std::size_t kMaxBytes = std::size_t{256} << 20;
const std::vector<std::string> kColumns = {
    "time_s", "north_m", "east_m", "down_m", "yaw_deg", "pitch_deg", "roll_deg"};
// Number of columns, the first ones, that each file has.
constexpr std::size_t kRequired = 4;
// Largest number of a path file, in metres, seconds or degrees. Its square stays far from overflow.
constexpr double kLargest = 1e9;

// The columns of a file: where each known column stands, and how many there are.
struct Header {
  std::vector<std::size_t> place;
  std::size_t columns = 0;
};

Header header_of(const std::string& line, const std::string& file) {
  const auto cells = cells_of(line);
  const Header header{places_of(kColumns, cells, {file, 1}), cells.size()};
  for (std::size_t i = 0; i < kRequired; ++i)
    if (header.place[i] == kNoColumn)
      throw Error("has no column " + kColumns[i] +
                      "; expected time_s,north_m,east_m,down_m[,yaw_deg,pitch_deg,roll_deg]",
                  {file, 1});
  return header;
}

double number_of(const std::string& cell, const std::string& column, const Where& where) {
  const auto value = number_from_text<double>(cell);
  if (!value || !(std::abs(*value) <= kLargest))
    throw Error(column + " is '" + cell.substr(0, 40) + "'; expected a number up to 1e9", where);
  return *value;
}

// Adds the values of one row, which must follow those before in time.
void add_row(const std::vector<std::string>& cells,
             const Header& header,
             const Where& where,
             Samples& samples) {
  if (cells.size() > header.columns)
    throw Error("has " + std::to_string(cells.size()) + " cells for " +
                    std::to_string(header.columns) + " columns; expected one each",
                where);
  const auto value = [&](std::size_t column) {
    const std::size_t place = header.place[column];
    if (place == kNoColumn) return 0.0;
    if (place >= cells.size()) throw Error("has no value for " + kColumns[column], where);
    return number_of(cells[place], kColumns[column], where);
  };
  const double time = value(0);
  if (!samples.times_s.empty() && time - samples.times_s.back() < kShortestStep_s)
    throw Error("time_s is " + cells[header.place[0]] +
                    ", not after the row before; expected times that increase",
                where);
  const Vector3 angle(value(4), value(5), value(6));
  samples.times_s.push_back(time);
  // The values are read in this order, so that an error names the first bad column.
  const double north = value(1);
  const double east = value(2);
  const double down = value(3);
  samples.positions_ned_m.emplace_back(north, east, down);
  samples.angles_deg.push_back(angle);
}

Samples parse_samples(std::string_view text, const std::string& file) {
  std::istringstream lines{std::string(without_mark(text))};
  std::string line;
  if (!std::getline(lines, line))
    throw Error("is empty; expected a header and at least two rows", {file});
  const Header header = header_of(line, file);
  Samples samples;
  for (std::size_t i = 0; i < 3; ++i)
    samples.has_angle[i] = header.place[kRequired + i] != kNoColumn;
  int number = 1;
  while (std::getline(lines, line)) {
    ++number;
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    add_row(cells_of(line), header, {file, number}, samples);
  }
  if (samples.times_s.size() < 2)
    throw Error("holds " + std::to_string(samples.times_s.size()) + " rows; expected at least two",
                {file, number});
  return samples;
}

}  // namespace

Path parse_path_csv(std::string_view text, const std::filesystem::path& name) {
  return path_through_samples(parse_samples(text, name.string()));
}

Samples read_path_samples(const std::filesystem::path& path) {
  return parse_samples(read_file(path, kMaxBytes), path.string());
}

Path read_path_file(const std::filesystem::path& path) {
  // Half of the step of the clock of a Matroska file, to which the time of a frame is rounded.
  constexpr double kRounding_s = 0.5e-3;
  const Path sampled = path_through_samples(read_path_samples(path));
  return straight_on(sampled, sampled.start_s() - kRounding_s, sampled.end_s() + kRounding_s);
}

}  // namespace airtruth::trajectory
