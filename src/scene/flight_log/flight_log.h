// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "foundation/geometry/transform.h"

// What flew with a video: the positions, attitudes and turn rates that a flight log holds, in the
// log's own order and on the log's own clock.
//
// | format            | file       | position | attitude | rates | clock                          |
// |-------------------|------------|----------|----------|-------|--------------------------------|
// | DJI subtitles     | .srt       | yes      | gimbal   |       | the video's                    |
// | GoPro GPMF        | .mp4, .360 | yes      |          |       | the video's                    |
// | PX4 ULog          | .ulg       | yes      | yes      | yes   | since the log's first message  |
// | ArduPilot DataFlash | .bin     | yes      | yes      | yes   | since the log's first message  |
// | GPX               | .gpx       | yes      |          |       | since the first point's time   |
// | airtruth CSV      | .csv       | yes      | optional | optional | as the file states it       |
//
// docs/formats/flight-log.md describes what is read from each.
namespace airtruth::flight_log {

enum class Format { kDjiSubtitles, kGpmf, kUlog, kDataFlash, kGpx, kCsv };
// "DJI subtitles", "GoPro GPMF", "PX4 ULog", "ArduPilot DataFlash", "GPX", "CSV".
const char* name(Format format);

// A position on the WGS 84 ellipsoid.
struct Fix {
  double time_s = 0;
  double latitude_deg = 0;   // -90 to 90
  double longitude_deg = 0;  // -180 to 180
  // Height above the log's own datum: mean sea level or the ellipsoid. Only differences are used.
  double altitude_m = 0;
  // Height above the place of take-off; empty where the log does not state it.
  std::optional<double> height_m;
};

// The attitude of the aircraft, or of the camera's gimbal for DJI subtitles.
struct Attitude {
  double time_s = 0;
  YawPitchRoll angles;
};

// The turn rates about the body's axes: x forward, y right, z down.
struct Rates {
  double time_s = 0;
  Vector3 in_body_radps = Vector3::Zero();
};

// The times of each list increase strictly and all numbers are finite.
struct FlightLog {
  Format format = Format::kCsv;
  // True where the log counts time from the first frame of the video that it was made with.
  bool is_on_video_clock = false;
  std::vector<Fix> fixes;
  std::vector<Attitude> attitudes;
  std::vector<Rates> rates;
  // Records that were left out: positions without a satellite fix or out of reach of their
  // neighbours, times that do not increase, numbers that are not finite or out of range.
  std::int64_t left_out = 0;
  // What is wrong with the first of them that is more than a missing fix or a repeated time, and
  // where it stands; may be empty.
  std::string first_fault;
};

// Reads the log in a file other than a video; its content decides the format. Bad records are left
// out and counted. An Error with the file, and the line of a text file, is thrown for an unknown
// format, a text that is none of the format's, a log with fewer than two positions, and for a bad
// record of airtruth's own CSV.
FlightLog read_flight_log(const std::filesystem::path& path);

// The same from the content of the file `name`.
FlightLog parse_flight_log(std::string_view content, const std::filesystem::path& name);

// A time between two neighbouring records.
struct Gap {
  double from_s = 0, to_s = 0;
  double length_s() const { return to_s - from_s; }
};

// The gaps of more than a length that share a time with [from_s, to_s].
template <typename Record>
std::vector<Gap> gaps(const std::vector<Record>& records,
                      double longer_than_s,
                      double from_s,
                      double to_s) {
  std::vector<Gap> found;
  for (std::size_t i = 1; i < records.size(); ++i) {
    const Gap gap{records[i - 1].time_s, records[i].time_s};
    if (gap.length_s() > longer_than_s && gap.from_s < to_s && gap.to_s > from_s)
      found.push_back(gap);
  }
  return found;
}

// Adds one of a DJI aircraft's subtitles, as a video holds them in a track of their own.
void add_dji_subtitle(FlightLog& log,
                      std::string_view text,
                      double time_s,
                      const std::string& file);

// Adds the positions of one packet of a GoPro's telemetry (camera/gyro/gpmf.h; streams GPS5 and
// GPS9), spread evenly over [begin_s, end_s) on the video's clock. Positions without a fix in three
// dimensions are left out and counted. A damaged packet adds nothing.
void add_gpmf_packet(FlightLog& log,
                     std::span<const std::uint8_t> packet,
                     double begin_s,
                     double end_s);

// The log without positions that no aircraft reaches from their neighbours: those that are kept
// form the longest run of positions of which each is within reach of the one before, continued on
// both sides by the positions within reach. Throws Error where the log spans more than a day.
FlightLog without_jumps(FlightLog log, const std::string& file);

}  // namespace airtruth::flight_log
