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

// As the background's light and lens have it.
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
  const BackgroundFiles files{stem.string() + ".mp4", stem.string() + ".mask.png"};
  // The video is the last to appear.
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

}  // namespace

BackgroundFiles prepare(const Background& background,
                        const Folder& folder,
                        const BuildOptions& options) {
  if (const auto given = options.videos.find(background.name); given != options.videos.end())
    return {given->second, std::nullopt};
  if (const auto* flight = std::get_if<synthetic::FlightOptions>(&background.source))
    return fly(background, *flight, folder, options);
  return {std::get<fs::path>(background.source), background.mask};
}

}  // namespace airtruth::dataset
