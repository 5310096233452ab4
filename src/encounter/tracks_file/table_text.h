// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "encounter/track/track.h"
#include "foundation/base/error.h"
#include "foundation/geometry/transform.h"

// Text files of rows and cells, read line by line, and their rows put together to tracks.
namespace airtruth::tracks_file {

// The lines of a text with content, each with its number. The mark of UTF-8 at the beginning,
// carriage returns and everything from '#' on are left out.
class Lines {
 public:
  Lines(std::string_view text, std::string file);

  // Goes to the next line with content; false at the end of the text.
  bool next();
  std::string_view line() const { return line_; }
  // The parts of the line between its commas; without a comma those between its blanks. Blanks
  // around a cell are left out, and one empty cell at the end, after a last comma, too.
  const std::vector<std::string_view>& cells() const { return cells_; }
  // The place of the present line.
  Where where() const { return {file_, number_}; }

 private:
  std::string_view rest_;
  std::string_view line_;
  std::vector<std::string_view> cells_;
  std::string file_;
  int number_ = 0;
};

// Numbers are written so that reading gives the same ones; -0 becomes 0.
inline double plain(double number) { return number + 0.0; }
inline Vector3 plain(const Vector3& v) { return v.array() + 0.0; }

// Whether the first line with content has this cell.
bool begins_with_column(std::string_view text, std::string_view column);

// Whether the word is one of `words`, which have blanks between them.
bool is_among(std::string_view word, std::string_view words);

// The largest number of a file of tracks, in its own units. Its square stays far from overflow.
constexpr double kMaxNumber = 1e9;

// The cell as a number. Throws Error where it is none, not finite or beyond kMaxNumber. `name` is
// the column in messages.
double number_in(std::string_view cell, std::string_view name, const Where& where);

// The cell as the name of an aircraft: blanks become '_'. Throws Error where it is empty, longer
// than 60 bytes, or holds quotes, '=', control characters or bytes beyond ASCII.
std::string aircraft_name_in(std::string_view cell, const Where& where);

// Units as the files of DAIDALUS and of MIT Lincoln Laboratory name them.

enum class Dimension { kNone, kLength, kAngle, kSpeed, kTime };

// The factor from the unit to metres, radians, metres per second or seconds; 1 for a unit of
// kNone. Square brackets around the name are left out. Empty where the dimension has no such unit.
//
//   factor_of("[nmi]", Dimension::kLength) == 1852
std::optional<double> factor_of(std::string_view unit, Dimension dimension);

// True where the word is the name of any unit, or stands in square brackets.
bool is_unit_word(std::string_view word);

// The names of a dimension's units, for messages: "m, km, ft, nmi".
std::string units_of(Dimension dimension);

// The largest number of aircraft in one encounter: a bound for untrusted files.
constexpr std::size_t kMaxAircraft = 1000;

class TrackBuilder {
 public:
  // Adds a state. Throws Error where the time is not after the last one of the same aircraft, or
  // there are too many aircraft.
  void add(const std::string& name,
           double time_s,
           const Vector3& position_ned_m,
           const Vector3* velocity_ned_mps,
           const Where& where);
  bool is_empty() const { return encounter_.aircraft.empty(); }
  // Hands over what was added and begins anew.
  track::Encounter take();

 private:
  track::Encounter encounter_;
  std::map<std::string, std::size_t> places_;
  std::size_t last_ = 0;
};

}  // namespace airtruth::tracks_file
