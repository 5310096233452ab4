// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstring>
#include <string>
#include <string_view>

#include "scene/flight_log/flight_log.h"

// One reader for each format of flight logs. `file` is the name that errors carry. The readers
// return what the file states; builder.h sorts out times that do not increase.
namespace airtruth::flight_log {

bool is_dji_subtitles(std::string_view content);
FlightLog from_dji_subtitles(std::string_view text, const std::string& file);

bool is_ulog(std::string_view content);
FlightLog from_ulog(std::string_view bytes, const std::string& file);

bool is_dataflash(std::string_view content);
FlightLog from_dataflash(std::string_view bytes, const std::string& file);

bool is_gpx(std::string_view content);
FlightLog from_gpx(std::string_view text, const std::string& file);

// The columns time_s,latitude_deg,longitude_deg,altitude_m and, each optional, height_m;
// yaw_deg,pitch_deg,roll_deg together; rate_x_radps,rate_y_radps,rate_z_radps together.
bool is_csv(std::string_view content);
FlightLog from_csv(std::string_view text, const std::string& file);

// The number of type T at byte `at`, stored with its lowest byte first. `bytes` must hold it.
template <typename T>
T little_endian(std::string_view bytes, std::size_t at) {
  static_assert(std::endian::native == std::endian::little);
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

}  // namespace airtruth::flight_log
