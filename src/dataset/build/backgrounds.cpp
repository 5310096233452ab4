// SPDX-License-Identifier: Apache-2.0
#include "dataset/build/backgrounds.h"

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "picture/video/reader.h"
#include "picture/video/still.h"
#include "sequence/demo/virtual_flight.h"
#include "sequence/frame/mask_picture.h"
#include "sequence/setup/from_scene.h"
#include "sequence/setup/world.h"

namespace airtruth::dataset {
namespace {

// Flight options with the sun and the lens of the background.
synthetic::FlightOptions flight_over(const Background& background,
                                     synthetic::FlightOptions flight) {
  flight.sun_azimuth_deg = background.light.sun_azimuth_deg;
  flight.sun_elevation_deg = background.light.sun_elevation_deg;
  flight.lens = sequence::lens_of(background.lens, {flight.width, flight.height});
  return flight;
}

BackgroundFiles fly(const Background& background,
                    const synthetic::FlightOptions& wanted,
                    const Folder& folder,
                    const BuildOptions& options) {
  const fs::path stem = folder.backgrounds() / background.name;
  BackgroundFiles files;
  files.video = stem.string() + ".mp4";
  files.mask = stem.string() + ".mask.png";
  // The video is the last file that appears.
  if (fs::exists(files.video)) return files;
  fs::create_directories(folder.backgrounds());
  const synthetic::Flight flight(flight_over(background, wanted));
  write_file(stem.string() + ".csv", synthetic::csv_from_flight(flight));
  video::write_still(*files.mask, sequence::picture_of(flight.own_aircraft()));
  sequence::VirtualFlightOptions how;
  how.stop = options.stop;
  how.progress = [&](std::int64_t done, std::int64_t total) {
    if (options.progress) options.progress({done, total, "flying " + background.name});
  };
  sequence::write_flight(flight, files.video, how);
  return files;
}

BackgroundFiles files_of(const Background& background,
                         const Folder& folder,
                         const BuildOptions& options) {
  BackgroundFiles files;
  if (const auto given = options.videos.find(background.name); given != options.videos.end()) {
    files.video = given->second;
    return files;
  }
  if (const auto* flight = std::get_if<synthetic::FlightOptions>(&background.source))
    return fly(background, *flight, folder, options);
  files.video = std::get<fs::path>(background.source);
  files.mask = background.mask;
  return files;
}

}  // namespace

BackgroundFiles prepare(const Background& background,
                        const Folder& folder,
                        const BuildOptions& options) {
  BackgroundFiles files = files_of(background, folder, options);
  add_facts(files);
  return files;
}

void add_facts(BackgroundFiles& files) {
  const video::StreamInfo info = video::Reader(files.video, {.threads = 1}).info();
  files.width = info.width;
  files.height = info.height;
  files.frame_rate_hz = info.frame_rate.value();
  files.frames = info.frame_count_estimate;
}

}  // namespace airtruth::dataset
