// SPDX-License-Identifier: Apache-2.0
#include <bit>
#include <cmath>
#include <cstring>

#include <fmt/format.h>

#include "encounter/track/track.h"
#include "encounter/tracks_file/formats.h"
#include "encounter/tracks_file/table_text.h"
#include "foundation/base/error.h"
#include "foundation/geometry/units.h"

namespace airtruth::tracks_file {
namespace {

static_assert(std::endian::native == std::endian::little, "the file is copied byte by byte");
// The number of updates is 16 bits wide in the file.
constexpr std::size_t kMaxUpdates = 65535;

// Reads values one after the other, and knows where it is.
class Reader {
 public:
  Reader(std::string_view bytes, const std::filesystem::path& file)
      : bytes_(bytes), file_(file.string()) {}

  [[noreturn]] void fail(const std::string& message) const {
    throw Error(fmt::format("{}{}", place_, message), {file_});
  }
  // What messages begin with: "encounter 2, aircraft 1: ".
  void set_place(std::string place) { place_ = std::move(place); }
  std::size_t rest() const { return bytes_.size() - at_; }

  template <typename Value>
  Value next(const char* what) {
    if (rest() < sizeof(Value))
      fail(fmt::format("ends at byte {} within {}; expected {} bytes more",
                       bytes_.size(),
                       what,
                       sizeof(Value) - rest()));
    Value value;
    std::memcpy(&value, bytes_.data() + at_, sizeof value);
    at_ += sizeof value;
    return value;
  }
  double number(const char* what) {
    const auto value = next<double>(what);
    if (!(std::abs(value) <= kMaxNumber))
      fail(fmt::format("{} is {}; expected a finite number up to 1e9 in size", what, value));
    return value;
  }
  Vector3 position_m() {
    const double north = number("north");
    const double east = number("east");
    const double altitude = number("altitude");
    return kMetresOfFoot * Vector3(north, east, -altitude);
  }

 private:
  std::string_view bytes_;
  std::string file_;
  std::string place_;
  std::size_t at_ = 0;
};

std::string name_of(std::uint32_t aircraft, std::uint32_t count) {
  if (count == 1) return "track";
  if (aircraft == 0) return "own";
  return aircraft == 1 ? "intruder" : fmt::format("intruder-{}", aircraft);
}

void read_updates(Reader& reader, track::Track& track) {
  const auto updates = reader.next<std::uint16_t>("the number of updates");
  if (reader.rest() / 32 < updates)
    reader.fail(fmt::format("has {} updates and {} bytes behind them; expected 32 bytes for each",
                            updates,
                            reader.rest()));
  for (std::uint16_t i = 0; i < updates; ++i) {
    const double time_s = reader.number("the time of an update");
    const Vector3 position = reader.position_m();
    // Some writers repeat the first position as an update at time 0.
    if (i == 0 && time_s == 0 && position == track.positions_ned_m[0]) continue;
    if (!(time_s > track.times_s.back()))
      reader.fail(fmt::format(
          "time {} s follows {} s; expected times that increase", time_s, track.times_s.back()));
    track.times_s.push_back(time_s);
    track.positions_ned_m.push_back(position);
  }
}

track::Encounter read_encounter(Reader& reader, std::uint32_t number, std::uint32_t aircraft) {
  track::Encounter encounter;
  const auto set_place = [&](std::uint32_t a) {
    reader.set_place(fmt::format("encounter {}, aircraft {}: ", number, a + 1));
  };
  for (std::uint32_t a = 0; a < aircraft; ++a) {
    set_place(a);
    encounter.aircraft.push_back({name_of(a, aircraft), {0.0}, {reader.position_m()}, {}});
  }
  for (std::uint32_t a = 0; a < aircraft; ++a) {
    set_place(a);
    read_updates(reader, encounter.aircraft[a]);
  }
  return encounter;
}

template <typename Value>
void append(std::string& bytes, Value value) {
  char raw[sizeof value];
  std::memcpy(raw, &value, sizeof value);
  bytes.append(raw, sizeof value);
}

void append_position(std::string& bytes, const Vector3& position_ned_m) {
  append(bytes, position_ned_m.x() / kMetresOfFoot);
  append(bytes, position_ned_m.y() / kMetresOfFoot);
  append(bytes, -position_ned_m.z() / kMetresOfFoot);
}

}  // namespace

std::vector<track::Encounter> parse_waypoints(std::string_view bytes,
                                              const std::filesystem::path& file) {
  Reader reader(bytes, file);
  const auto count = reader.next<std::uint32_t>("the number of encounters");
  const auto aircraft = reader.next<std::uint32_t>("the number of aircraft");
  if (count == 0 || aircraft == 0 || aircraft > kMaxAircraft)
    reader.fail(fmt::format("holds {} encounters of {} aircraft; expected 1 or more, of 1 to {}",
                            count,
                            aircraft,
                            kMaxAircraft));
  const std::size_t smallest = std::size_t{aircraft} * (24 + 2);
  if (reader.rest() / smallest < count)
    reader.fail(
        fmt::format("announces {} encounters of {} aircraft in {} bytes; expected {} or more",
                    count,
                    aircraft,
                    reader.rest(),
                    smallest * count));
  std::vector<track::Encounter> encounters;
  for (std::uint32_t e = 0; e < count; ++e)
    encounters.push_back(read_encounter(reader, e + 1, aircraft));
  reader.set_place("");
  if (reader.rest() > 0)
    reader.fail(fmt::format(
        "goes on for {} bytes after encounter {}; expected its end there", reader.rest(), count));
  return encounters;
}

std::string waypoint_head(std::uint32_t encounters, std::uint32_t aircraft) {
  std::string bytes;
  append(bytes, encounters);
  append(bytes, aircraft);
  return bytes;
}

std::string waypoints_of(const track::Encounter& encounter, std::uint32_t aircraft) {
  if (encounter.aircraft.size() != aircraft)
    throw Error(
        fmt::format("an encounter has {} aircraft, another {}; a waypoint file (.dat) holds "
                    "the same number in each",
                    encounter.aircraft.size(),
                    aircraft));
  std::string bytes;
  for (const track::Track& track : encounter.aircraft) {
    if (track.times_s.front() != encounter.aircraft.front().times_s.front())
      throw Error(
          fmt::format("'{}' begins at {} s and '{}' at {} s; in a waypoint file (.dat) all "
                      "begin at once",
                      encounter.aircraft.front().name,
                      encounter.aircraft.front().times_s.front(),
                      track.name,
                      track.times_s.front()));
    if (track.size() > kMaxUpdates + 1)
      throw Error(fmt::format("'{}' has {} samples; a waypoint file (.dat) holds up to {}",
                              track.name,
                              track.size(),
                              kMaxUpdates + 1));
    append_position(bytes, track.positions_ned_m.front());
  }
  for (const track::Track& track : encounter.aircraft) {
    append(bytes, static_cast<std::uint16_t>(track.size() - 1));
    for (std::size_t i = 1; i < track.size(); ++i) {
      append(bytes, track.times_s[i] - track.times_s.front());
      append_position(bytes, track.positions_ned_m[i]);
    }
  }
  return bytes;
}

}  // namespace airtruth::tracks_file
