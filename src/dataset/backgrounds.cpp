// SPDX-License-Identifier: Apache-2.0
#include "dataset/backgrounds.h"

#include "base/error.h"
#include "base/files.h"
#include "sequence/mask_picture.h"
#include "sequence/virtual_flight.h"
#include "sequence/world.h"
#include "video/still.h"

namespace airtruth::dataset {
namespace {

synthetic::FlightOptions flight_options(const Background& background,
                                        const VirtualBackground& flight) {
  synthetic::FlightOptions options;
  options.seed = flight.seed;
  options.frame_count = static_cast<int>(flight.frame_count);
  options.width = flight.width;
  options.height = flight.height;
  options.cloud_cover = flight.cloud_cover;
  options.speed_mps = flight.speed_mps;
  options.altitude_m = flight.altitude_m;
  options.sun_azimuth_deg = background.light.sun_azimuth_deg;
  options.sun_elevation_deg = background.light.sun_elevation_deg;
  options.lens = sequence::lens_of(background.lens, {flight.width, flight.height});
  return options;
}

BackgroundFiles fly(const Background& background,
                    const VirtualBackground& wanted,
                    const Folder& folder,
                    const BuildOptions& options) {
  const fs::path stem = folder.backgrounds() / background.name;
  const BackgroundFiles files{stem.string() + ".mp4", stem.string() + ".mask.png"};
  // The video is the last to appear.
  if (fs::exists(files.video)) return files;
  fs::create_directories(folder.backgrounds());
  const synthetic::Flight flight(flight_options(background, wanted));
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

}  // namespace

BackgroundFiles prepare(const Background& background,
                        const Folder& folder,
                        const BuildOptions& options) {
  if (const auto given = options.videos.find(background.name); given != options.videos.end())
    return {given->second, std::nullopt};
  if (const auto* flight = std::get_if<VirtualBackground>(&background.source))
    return fly(background, *flight, folder, options);
  return {std::get<fs::path>(background.source), background.mask};
}

}  // namespace airtruth::dataset
