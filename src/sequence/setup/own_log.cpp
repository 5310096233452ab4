// SPDX-License-Identifier: Apache-2.0
#include "sequence/setup/own_log.h"

#include <fstream>
#include <string>

#include <fmt/format.h>

#include "foundation/base/error.h"
#include "picture/video/telemetry.h"
#include "scene/flight_log/gpmf.h"
#include "scene/flight_log/local_path.h"

namespace airtruth::sequence {
namespace {

// An MP4 file has "ftyp" as its first box (ISO/IEC 14496-12, 4.3).
bool is_mp4(const std::filesystem::path& path) {
  std::string head(8, '\0');
  std::ifstream(path, std::ios::binary)
      .read(head.data(), static_cast<std::streamsize>(head.size()));
  return head.substr(4) == "ftyp";
}

flight_log::FlightLog log_in_video(const std::filesystem::path& path) {
  flight_log::FlightLog log;
  log.format = flight_log::Format::kGpmf;
  log.is_on_video_clock = true;
  const auto packets = video::read_telemetry(path);
  if (packets.empty())
    throw Error("is a video without a GoPro's telemetry; expected a flight log", {path.string()});
  for (const video::TelemetryPacket& packet : packets)
    flight_log::add_gpmf_packet(log, packet.bytes, packet.begin_s, packet.end_s);
  if (log.fixes.size() < 2)
    throw Error(fmt::format("holds {} positions with a fix ({} without); expected at least two",
                            log.fixes.size(),
                            log.left_out),
                {path.string()});
  return log;
}

double offset_of(const scene::Camera& camera, const flight_log::FlightLog& log) {
  if (camera.log_offset_s) return *camera.log_offset_s;
  if (log.is_on_video_clock) return 0;
  throw Error(fmt::format("the log ({}) has a clock of its own; expected log_offset_s, which "
                          "'airtruth log align' finds",
                          flight_log::name(log.format)),
              camera.where);
}

// The attitude that is held from the first frame on.
trajectory::AttitudeOverride held(const scene::Camera& camera,
                                  const flight_log::FlightLog& log,
                                  const trajectory::Path& path,
                                  double offset_s) {
  YawPitchRoll attitude = camera.attitude_yaw_pitch_roll_deg;
  if (!camera.attitude_is_stated) {
    const auto logged = flight_log::attitude_at(log, offset_s);
    attitude =
        logged ? *logged : YawPitchRoll{yaw_pitch_roll(path.at(0)->world_from_body).yaw_deg, 0, 0};
  }
  return {attitude.yaw_deg, attitude.pitch_deg, attitude.roll_deg};
}

}  // namespace

flight_log::FlightLog read_log(const std::filesystem::path& path) {
  return is_mp4(path) ? log_in_video(path) : flight_log::read_flight_log(path);
}

trajectory::Path path_from_log(const scene::Camera& camera) {
  const flight_log::FlightLog log = read_log(*camera.log);
  const double offset_s = offset_of(camera, log);
  Vector3 first = camera.position_ned_m;
  if (!camera.position_is_stated)
    if (const auto height_m = flight_log::height_at(log, offset_s)) first = {0, 0, -*height_m};
  const flight_log::Placement placement{offset_s, first};
  try {
    const trajectory::Path path = flight_log::local_path(log, placement);
    if (camera.follows_log_attitude && !camera.attitude_is_stated && !log.attitudes.empty())
      return path;
    return flight_log::local_path(log, placement, held(camera, log, path, offset_s));
  } catch (const Error& error) {
    throw Error(error.message(), camera.where);
  }
}

}  // namespace airtruth::sequence
