// SPDX-License-Identifier: Apache-2.0
#include "dataset/build/backgrounds.h"

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "picture/video/reader.h"
#include "picture/video/still.h"
#include "sequence/demo/virtual_flight.h"
#include "sequence/insertion/masks.h"
#include "sequence/setup/from_scene.h"
#include "sequence/setup/level_camera.h"
#include "sequence/setup/world.h"

namespace airtruth::build {
namespace {

// Flight options with the sun and the lens of the background.
synthetic::FlightOptions flight_over(const catalogue::Background& background,
                                     synthetic::FlightOptions flight) {
  flight.sun_azimuth_deg = background.light.sun_azimuth_deg;
  flight.sun_elevation_deg = background.light.sun_elevation_deg;
  flight.lens = setup::lens_of(background.lens, {flight.width, flight.height});
  return flight;
}

catalogue::BackgroundFiles fly(const catalogue::Background& background,
                               const synthetic::FlightOptions& wanted,
                               const catalogue::Folder& folder,
                               const BuildOptions& options) {
  const fs::path stem = folder.backgrounds() / background.name;
  catalogue::BackgroundFiles files;
  files.video = stem.string() + ".mp4";
  files.mask = stem.string() + ".mask.png";
  // The video is the last file that appears.
  if (fs::exists(files.video)) return files;
  fs::create_directories(folder.backgrounds());
  const synthetic::Flight flight(flight_over(background, wanted));
  write_file(stem.string() + ".csv", synthetic::csv_from_flight(flight));
  video::write_still(*files.mask, insertion::picture_of(flight.own_aircraft()));
  demo::VirtualFlightOptions how;
  how.stop = options.stop;
  how.progress = [&](std::int64_t done, std::int64_t total) {
    if (options.progress) options.progress({done, total, "flying " + background.name});
  };
  demo::write_flight(flight, files.video, how);
  return files;
}

catalogue::BackgroundFiles files_of(const catalogue::Background& background,
                                    const catalogue::Folder& folder,
                                    const BuildOptions& options) {
  catalogue::BackgroundFiles files;
  if (const auto* flight = std::get_if<synthetic::FlightOptions>(&background.source))
    return fly(background, *flight, folder, options);
  files.video = std::get<fs::path>(background.source);
  files.mask = background.mask;
  return files;
}

}  // namespace

catalogue::BackgroundFiles prepare(const catalogue::Background& background,
                                   const catalogue::Folder& folder,
                                   const BuildOptions& options) {
  catalogue::BackgroundFiles files = files_of(background, folder, options);
  const video::StreamInfo info =
      video::Reader(files.video, {.picture_rate_hz = background.frame_rate_hz, .threads = 1})
          .info();
  files.width = info.width;
  files.height = info.height;
  files.frame_rate_hz = info.frame_rate.value();
  files.frames = end_of(background, info.frame_count_estimate);
  files.log_start = log_start(background, files.video);
  return files;
}

catalogue::LogStart log_start(const catalogue::Background& background, const fs::path& video) {
  if (!background.camera.log) return {};
  scene::Camera camera = background.camera;
  camera.clip_start_s = video::time_of_first_frame_s(
      video, {.first_frame = background.first_frame, .picture_rate_hz = background.frame_rate_hz});
  return {camera.clip_start_s, setup::level_attitude(camera)};
}

video::StreamInfo stream_of(const catalogue::Background& background) {
  const auto* flight = std::get_if<synthetic::FlightOptions>(&background.source);
  if (flight == nullptr)
    return video::Reader(std::get<fs::path>(background.source),
                         {.picture_rate_hz = background.frame_rate_hz, .threads = 1})
        .info();
  video::StreamInfo info;
  info.width = flight->width;
  info.height = flight->height;
  info.frame_rate = {static_cast<int>(std::lround(1000 * flight->frame_rate_hz)), 1000};
  info.frame_count_estimate = flight->frame_count;
  return info;
}

}  // namespace airtruth::build
