// SPDX-License-Identifier: Apache-2.0
#include "scene/flight_log/flight_log.h"

#include <array>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "scene/flight_log/builder.h"
#include "scene/flight_log/formats.h"

namespace airtruth::flight_log {
namespace {

constexpr std::size_t kMaxBytes = std::size_t{1} << 30;  // ten hours of a ULog at 30 kB a second

FlightLog read_by_format(std::string_view content, const std::string& file) {
  if (content.empty()) throw Error("is empty; expected a flight log", {file});
  if (is_ulog(content)) return from_ulog(content, file);
  if (is_dataflash(content)) return from_dataflash(content, file);
  if (is_gpx(content)) return from_gpx(content, file);
  if (is_dji_subtitles(content)) return from_dji_subtitles(content, file);
  if (is_csv(content)) return from_csv(content, file);
  throw Error(
      "is no flight log that airtruth reads; expected DJI .srt, PX4 .ulg, ArduPilot .bin, .gpx, "
      "or .csv with time_s,latitude_deg,longitude_deg,altitude_m",
      {file});
}

}  // namespace

const char* name(Format format) {
  constexpr std::array kNames = {
      "DJI subtitles", "GoPro GPMF", "PX4 ULog", "ArduPilot DataFlash", "GPX", "CSV"};
  return kNames[static_cast<std::size_t>(format)];
}

FlightLog parse_flight_log(std::string_view content, const std::filesystem::path& name) {
  const std::string file = name.string();
  FlightLog log = without_jumps(read_by_format(content, file), file);
  require_positions(log, file);
  return log;
}

FlightLog read_flight_log(const std::filesystem::path& path) {
  return parse_flight_log(read_file(path, kMaxBytes), path);
}

}  // namespace airtruth::flight_log
