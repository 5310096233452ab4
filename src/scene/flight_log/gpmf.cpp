// SPDX-License-Identifier: Apache-2.0
#include "camera/gyro/gpmf.h"

#include <cmath>
#include <vector>

#include "scene/flight_log/flight_log.h"

namespace airtruth::flight_log {
namespace {

using gyro::big_endian;
using gyro::GpmfElement;

// The kind of fix of a position in three dimensions; 2 is one without an altitude (gpmf-parser).
constexpr std::uint32_t kGpmfFix3d = 3;
// GPS9 holds seven 32-bit numbers and two 16-bit ones, the last of which is the kind of fix.
constexpr std::size_t kGps9Bytes = 32, kGps9FixAt = 30;
// GPS5 holds five 32-bit numbers.
constexpr std::size_t kGps5Bytes = 20;
// GLPI, the position of a Karma drone: a time, latitude, longitude, altitude and height in 32 bits
// each, three speeds and a course in 16 bits. It has the scales of all nine, and no kind of fix.
constexpr std::size_t kKarmaBytes = 28;

double signed_at(const GpmfElement& e, std::size_t at) {
  return static_cast<std::int32_t>(big_endian(e.data, at, 4));
}

// What a stream states about its positions.
struct Stream {
  std::vector<double> scales;
  std::uint32_t fix = 0;
  std::vector<Fix> fixes;
  std::int64_t left_out = 0;
};

void read_scale(const GpmfElement& e, Stream& stream) {
  if (e.type != 'l' || e.size != 4 || e.count < 3) return;
  stream.scales.clear();
  for (std::size_t i = 0; i < e.count; ++i) stream.scales.push_back(signed_at(e, 4 * i));
}

void read_positions(const GpmfElement& e, Stream& stream) {
  const bool states_fix = e.key == "GPS9";
  const bool is_karma = e.key == "GLPI";
  if (e.size != (is_karma ? kKarmaBytes : states_fix ? kGps9Bytes : kGps5Bytes)) return;
  // The place of the latitude among the numbers.
  const std::size_t latitude = is_karma ? 1 : 0;
  if (stream.scales.size() < latitude + 3) return;
  const double* scale = stream.scales.data() + latitude;
  for (std::size_t i = 0; i < 3; ++i)
    if (!(scale[i] > 0)) return;
  for (std::size_t i = 0; i < e.count; ++i) {
    const std::size_t at = i * e.size + 4 * latitude;
    const std::uint32_t fix = is_karma     ? kGpmfFix3d
                              : states_fix ? big_endian(e.data, at + kGps9FixAt, 2)
                                           : stream.fix;
    Fix position;
    position.latitude_deg = signed_at(e, at) / scale[0];
    position.longitude_deg = signed_at(e, at + 4) / scale[1];
    position.altitude_m = signed_at(e, at + 8) / scale[2];
    if (fix < kGpmfFix3d || std::abs(position.latitude_deg) > 90 ||
        std::abs(position.longitude_deg) > 180)
      position.latitude_deg = NAN;  // left out below, where its place in time still counts
    stream.fixes.push_back(position);
  }
}

Stream stream_of(std::span<const std::uint8_t> bytes) {
  Stream stream;
  gyro::each_gpmf_element(bytes, [&](const GpmfElement& e) {
    if (e.key == "SCAL") read_scale(e, stream);
    if (e.key == "GPSF" && e.type == 'L' && e.size == 4 && e.count > 0)
      stream.fix = big_endian(e.data, 0, 4);
    if (e.key == "GPS5" || e.key == "GPS9" || e.key == "GLPI") read_positions(e, stream);
  });
  return stream;
}

}  // namespace

void add_gpmf_packet(FlightLog& log,
                     std::span<const std::uint8_t> packet,
                     double begin_s,
                     double end_s) {
  gyro::each_gpmf_stream(packet, [&](std::span<const std::uint8_t> bytes) {
    const Stream stream = stream_of(bytes);
    const auto count = static_cast<double>(stream.fixes.size());
    for (std::size_t i = 0; i < stream.fixes.size(); ++i) {
      Fix fix = stream.fixes[i];
      fix.time_s = begin_s + (static_cast<double>(i) + 0.5) * (end_s - begin_s) / count;
      const bool follows = log.fixes.empty() || fix.time_s > log.fixes.back().time_s;
      if (std::isnan(fix.latitude_deg) || !follows)
        ++log.left_out;
      else
        log.fixes.push_back(fix);
    }
  });
}

}  // namespace airtruth::flight_log
