// SPDX-License-Identifier: Apache-2.0
#include "dataset/build/inputs.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "aircraft/fleet/fleet.h"
#include "dataset/catalogue/expand.h"
#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "picture/video/numbered_images.h"
#include "picture/video/reader.h"
#include "picture/video/still.h"
#include "picture/video/writer.h"
#include "sequence/demo/demo.h"
#include "sequence/insertion/masks.h"
#include "sequence/pipeline/resolved_scene.h"
#include "sequence/setup/from_scene.h"
#include "sequence/setup/level_camera.h"

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
  catalogue::BackgroundFiles files = files_of_flight(background, folder);
  const std::string lens = sha256_of_flight_lens(background);
  const fs::path kept_lens = stem.string() + ".lens.sha256";
  // The video is the last file that appears.
  if (fs::exists(files.video)) {
    if (fs::exists(kept_lens) && read_file(kept_lens) != lens)
      throw Error(
          "was flown through another lens than " + background.lens.file->string() +
              " states now (its SHA-256 differs); expected that lens, or another folder for "
              "the set",
          {files.video.string()});
    return files;
  }
  fs::create_directories(folder.backgrounds());
  if (!lens.empty()) write_file(kept_lens, lens);
  // A stream, which no plan has checked, comes here first.
  const synthetic::Flight flight = setup::at_place(
      background.where, [&] { return synthetic::Flight(flight_over(background, wanted)); });
  write_file(stem.string() + ".csv", synthetic::csv_from_flight(flight));
  video::write_still(*files.mask, insertion::picture_of(flight.own_aircraft()));
  const auto progress = [&](std::int64_t done, std::int64_t total) {
    if (options.progress) options.progress({done, total, "flying " + background.name});
  };
  demo::write_flight(flight, files.video, {.stop = options.stop, .progress = progress});
  return files;
}

}  // namespace

catalogue::BackgroundFiles files_of_flight(const catalogue::Background& background,
                                           const catalogue::Folder& folder) {
  const std::string stem = folder.backgrounds() / background.name;
  return {.video = stem + ".mp4", .mask = stem + ".mask.png"};
}

std::string sha256_of_flight_lens(const catalogue::Background& background) {
  if (!std::holds_alternative<synthetic::FlightOptions>(background.source) || !background.lens.file)
    return "";
  return sha256_of_file(*background.lens.file);
}

catalogue::BackgroundFiles prepare(const catalogue::Background& background,
                                   const catalogue::Folder& folder,
                                   const BuildOptions& options) {
  const auto* flight = std::get_if<synthetic::FlightOptions>(&background.source);
  catalogue::BackgroundFiles files =
      flight != nullptr ? fly(background, *flight, folder, options)
                        : catalogue::BackgroundFiles{.video = std::get<fs::path>(background.source),
                                                     .mask = background.mask};
  video::Reader reader(files.video, {.picture_rate_hz = background.frame_rate_hz, .threads = 1});
  take_facts(reader.info(), files);
  // A clip may begin at any frame that is there, and an estimate may be of the sound's length.
  const video::StreamInfo& info = reader.info();
  if ((!info.is_frame_count_stated || info.variable_frame_rate) && reader.next()) {
    std::vector<double> shown_s = reader.times_s(end_of(background, video::kAllFrames));
    if (!shown_s.empty()) files.frames = std::ssize(shown_s);
    if (!video::are_of_rate(shown_s, files.frame_rate_hz)) files.times_s = std::move(shown_s);
  }
  files.frames = end_of(background, files.frames);
  files.camera = camera_with_log(background, files.video);
  if (files.camera) {
    scene::Camera as_stated = *files.camera;
    as_stated.attitude_yaw_pitch_roll_deg = background.camera.attitude_yaw_pitch_roll_deg;
    setup::warn_of_hover(as_stated, options.warn);
  }
  return files;
}

void take_facts(const video::StreamInfo& info, catalogue::BackgroundFiles& files) {
  files.width = info.width;
  files.height = info.height;
  files.pixel_aspect = info.sample_aspect.value();
  files.frame_rate_hz = info.frame_rate.value();
  files.frames = info.frame_count_estimate;
}

std::optional<scene::Camera> camera_with_log(const catalogue::Background& background,
                                             const fs::path& video) {
  if (!background.camera.log) return std::nullopt;
  scene::Camera camera = background.camera;
  setup::state_clip_start(camera, video, background.first_frame, background.frame_rate_hz);
  if (const auto level = setup::level_attitude(camera)) camera.attitude_yaw_pitch_roll_deg = level;
  return camera;
}

video::StreamInfo stream_of(const catalogue::Background& background) {
  const auto* flight = std::get_if<synthetic::FlightOptions>(&background.source);
  if (flight == nullptr)
    return video::Reader(std::get<fs::path>(background.source),
                         {.first_frame = background.first_frame,
                          .picture_rate_hz = background.frame_rate_hz,
                          .threads = 1,
                          .where = background.where})
        .info();
  if (background.first_frame >= flight->frame_count)
    throw Error(fmt::format("the flight holds {} frames; first_frame = {} is past its end",
                            flight->frame_count,
                            background.first_frame),
                background.where);
  video::StreamInfo info;
  info.width = flight->width;
  info.height = flight->height;
  info.frame_rate = {static_cast<int>(std::lround(1000 * flight->frame_rate_hz)), 1000};
  info.frame_count_estimate = flight->frame_count;
  info.is_frame_count_stated = true;
  return info;
}

namespace {

// Checks video, mask, lens, camera file and path of a background. Each sequence decides how much of
// the clip it uses, and the camera's path must cover only that part.
void check_background(const catalogue::Catalogue& catalogue, std::size_t place) {
  const catalogue::Background& background = catalogue.backgrounds[place];
  const auto* video = std::get_if<fs::path>(&background.source);
  // The reader checks a pattern of numbered images.
  if (video != nullptr && video->string().find('%') == std::string::npos && !fs::exists(*video))
    throw Error("the video of background '" + background.name + "', " + video->string() +
                    ", does not exist",
                background.where);
  if (video == nullptr && background.mask)
    throw Error("mask has no effect with flight, which has a mask of its own", background.where);
  if (const auto* flight = std::get_if<synthetic::FlightOptions>(&background.source))
    setup::at_place(background.where,
                    [&] { synthetic::check_options(flight_over(background, *flight)); });
  scene::Scene scene = catalogue::scene_over(catalogue, place);
  scene.background.mask = background.mask;
  // A log on the video's clock is asked for its part from there on.
  if (video != nullptr) {
    scene.background.video = *video;
    scene.background.first_frame = background.first_frame;
  }
  video::StreamInfo info = stream_of(background);
  video::check_output(info, scene.output.video, background.where);
  info.frame_count_estimate = 0;  // unknown
  pipeline::check_scene(scene, info);
}

// The names of one rule that draws differ by their numbers; those of a product (sky-2 with x, sky
// with 2-x) and of two rules may coincide. Hashes are compared because a million names must cost no
// more than eight bytes each.
void check_names(const catalogue::Catalogue& catalogue) {
  const auto& rules = catalogue.rules;
  if (rules.size() == 1 && !std::holds_alternative<catalogue::Product>(rules[0])) return;
  const catalogue::Expansion expansion(catalogue);
  std::vector<std::size_t> hashes;
  hashes.reserve(static_cast<std::size_t>(expansion.size()));
  const std::hash<std::string> hash;
  for (std::int64_t i = 0; i < expansion.size(); ++i) hashes.push_back(hash(expansion.at(i).name));
  std::vector<std::size_t> sorted = hashes;
  std::sort(sorted.begin(), sorted.end());
  const auto twin = std::adjacent_find(sorted.begin(), sorted.end());
  if (twin == sorted.end()) return;
  const auto first = std::find(hashes.begin(), hashes.end(), *twin);
  const auto second = std::find(first + 1, hashes.end(), *twin);
  const std::string name = expansion.at(first - hashes.begin()).name;
  const catalogue::Item other = expansion.at(second - hashes.begin());
  if (other.name == name)
    throw Error("two sequences are named '" + name + "'; expected another name here", other.where);
}

}  // namespace

void check_sources(const catalogue::Catalogue& catalogue) {
  for (const catalogue::Aircraft& aircraft : catalogue.aircraft)
    setup::at_place(aircraft.where, [&] { return fleet::aircraft_file(aircraft.aircraft); });
  for (std::size_t i = 0; i < catalogue.backgrounds.size(); ++i) check_background(catalogue, i);
  check_names(catalogue);
}

catalogue::Catalogue with_videos(catalogue::Catalogue catalogue,
                                 const std::map<std::string, fs::path>& videos) {
  for (const auto& [name, video] : videos) {
    const auto replaced =
        std::ranges::find(catalogue.backgrounds, name, &catalogue::Background::name);
    if (replaced == catalogue.backgrounds.end())
      throw Error("there is no background '" + name + "' to replace", {catalogue.file.string()});
    replaced->source = video;
    replaced->mask.reset();
    if (!video::numbered_images(video)) replaced->frame_rate_hz.reset();
    std::erase_if(replaced->occluders, [](const scene::Occluder& one) { return one.mask; });
  }
  return catalogue;
}

}  // namespace airtruth::build
