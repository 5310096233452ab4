// SPDX-License-Identifier: Apache-2.0
#include "dataset/catalogue/catalogue.h"

#include <algorithm>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "dataset/catalogue/slurm_options.h"
#include "foundation/base/files.h"
#include "scene/scene/tables.h"

namespace airtruth::catalogue {
namespace {

using scene::TableReader;

std::string required(const TableReader& table, std::string_view key) {
  if (auto text = table.text(key)) return *text;
  throw Error("has no " + std::string(key), table.where());
}

std::string required_name(const TableReader& table) {
  if (auto name = table.file_name("name")) return *name;
  throw Error("has no name", table.where());
}

synthetic::FlightOptions flight_from(const TableReader& table) {
  synthetic::FlightOptions flight;
  flight.frame_count = 300;
  flight.seed = static_cast<std::uint64_t>(
      table.whole("seed", 0, std::numeric_limits<std::int64_t>::max()).value_or(1));
  flight.frame_count =
      static_cast<int>(table.whole("frame_count", 1, 1'000'000).value_or(flight.frame_count));
  const auto side = [&](const char* key, int usual) {
    const auto pixels = static_cast<int>(table.whole(key, 64, 8192).value_or(usual));
    if (pixels % 2 != 0)  // its video is H.264 with halved chroma
      table.fail(key, fmt::format("{} is {}; expected an even number of pixels", key, pixels));
    return pixels;
  };
  flight.width = side("width", flight.width);
  flight.height = side("height", flight.height);
  flight.cloud_cover = table.number("cloud_cover", scene::kShare).value_or(flight.cloud_cover);
  flight.speed_mps = table.number("speed_mps", scene::kFlightSpeed).value_or(flight.speed_mps);
  flight.altitude_m =
      table.number("altitude_m", scene::kFlightAltitude).value_or(flight.altitude_m);
  return flight;
}

Background background_from(const TableReader& table) {
  Background background;
  background.where = table.where();
  background.name = required_name(table);
  table.exclude("video", {"flight"});
  if (const auto video = table.path("video")) {
    background.source = *video;
  } else if (table.has("flight")) {
    background.source = flight_from(table.table(
        "flight",
        {"seed", "frame_count", "width", "height", "cloud_cover", "speed_mps", "altitude_m"}));
  } else {
    throw Error("background '" + background.name + "' has neither video nor flight", table.where());
  }
  background.mask = table.path("mask");
  background.first_frame = table.whole("first_frame", 0, kMost).value_or(0);
  background.frame_count = table.whole("frame_count", 1, kMost);
  background.frame_rate_hz = table.number("frame_rate_hz", scene::kFrameRate_hz);
  const scene::Limits weight{"a weight from 0.001 to 1e6", 0.001, 1e6};
  background.weight = table.number("weight", weight).value_or(background.weight);
  background.lens = scene::lens_in(table);
  background.motion = scene::motion_in(table);
  background.camera = scene::camera_in(table, background.motion);
  const auto* flight = std::get_if<synthetic::FlightOptions>(&background.source);
  if (flight != nullptr && !table.has("camera")) {
    background.camera.position_ned_m = Vector3(0, 0, -flight->altitude_m);
    background.camera.velocity_ned_mps = Vector3(flight->speed_mps, 0, 0);  // heads north
  }
  // Encounters are drawn before a frame is read, so that no horizon gives an attitude. That of a
  // log without one is that of BackgroundFiles::camera.
  if (!background.camera.log && !background.camera.path_file &&
      !background.camera.attitude_yaw_pitch_roll_deg)
    background.camera.attitude_yaw_pitch_roll_deg = YawPitchRoll{};
  background.camera_model = scene::camera_model_in(table);
  background.realism = scene::realism_in(table);
  background.light = scene::light_in(table);
  if (flight != nullptr && !scene::kFlightSunElevation.holds(background.light.sun_elevation_deg))
    throw Error(fmt::format("sun_elevation_deg is {}; expected {} over a flight",
                            background.light.sun_elevation_deg,
                            scene::kFlightSunElevation.expected),
                table.where("light"));
  background.occluders = scene::occluders_in(table);
  return background;
}

Trajectory trajectory_from(const TableReader& table) {
  Trajectory trajectory;
  scene::Intruder& flown = trajectory.flown;
  flown.where = table.where();
  trajectory.name = required_name(table);
  table.exclude("encounter", {"seen", "waypoints_ned_m", "speed_mps", "times_s"});
  table.exclude("seen", {"waypoints_ned_m", "speed_mps", "times_s"});
  trajectory.frame_count = table.whole("frame_count", 1, kMost);
  if (table.has("encounter")) flown.encounter = scene::encounter_in(table);
  flown.seen = scene::seen_in(table);
  if (flown.encounter || !flown.seen.empty()) return trajectory;
  const auto points = table.points("waypoints_ned_m", scene::kPosition);
  if (!points || points->size() < 2)
    throw Error("trajectory '" + trajectory.name + "' has fewer than two waypoints_ned_m",
                table.where());
  flown.waypoints_ned_m = *points;
  table.exclude("speed_mps", {"times_s"});
  flown.speed_mps = table.number("speed_mps", scene::kSpeed);
  flown.times_s = table.numbers("times_s", scene::kTime).value_or(std::vector<double>{});
  if (!flown.speed_mps && flown.times_s.size() != flown.waypoints_ned_m.size())
    throw Error("trajectory '" + trajectory.name + "' has " +
                    std::to_string(flown.waypoints_ned_m.size()) + " waypoints and " +
                    std::to_string(flown.times_s.size()) +
                    " times_s; expected one for each, or speed_mps",
                table.where());
  return trajectory;
}

// Throws Error where the name of a table is one of those before it.
void refuse_twice(std::set<std::string>& names, const TableReader& table, const char* what) {
  const std::string name = required_name(table);
  if (!names.insert(name).second)
    throw Error(fmt::format("two {} are named '{}'", what, name), table.where("name"));
}

Product listed_from(const TableReader& table, const Catalogue& catalogue) {
  const auto only = [&](const char* key, const auto& things) {
    return std::vector{place_of(things, required(table, key), key, table.where(key))};
  };
  return {required_name(table),
          only("background", catalogue.backgrounds),
          only("trajectory", catalogue.trajectories),
          only("aircraft", catalogue.aircraft),
          table.whole("frame_count", 1, kMost),
          0,
          table.where()};
}

Product product_from(const TableReader& table, const Catalogue& catalogue) {
  Product product;
  product.where = table.where();
  product.name = table.file_name("name").value_or("{background}{trajectory}{aircraft}");
  expect_parts(table, product.name, {"{background}", "{trajectory}", "{aircraft}"});
  product.backgrounds = places_of(table, "backgrounds", catalogue.backgrounds, "background");
  product.trajectories = places_of(table, "trajectories", catalogue.trajectories, "trajectory");
  product.aircraft = places_of(table, "aircraft", catalogue.aircraft, "aircraft");
  product.frame_count = table.whole("frame_count", 1, kMost);
  const auto varies = [&](const char* part, std::size_t count) {
    if (count > 1 && product.name.find(part) == std::string::npos)
      table.fail(
          "name",
          "name lacks " + std::string(part) + ", of which there are " + std::to_string(count));
  };
  varies("{background}", product.backgrounds.size());
  varies("{trajectory}", product.trajectories.size());
  varies("{aircraft}", product.aircraft.size());
  product.negatives = table.number("negatives", scene::kShare).value_or(catalogue.negatives);
  return product;
}

// The parts from which sequences are made: backgrounds, aircraft and trajectories.
void add_parts(const TableReader& root, Catalogue& catalogue) {
  std::set<std::string> backgrounds, aircraft, trajectories;
  for (const TableReader& table : root.tables(
           "background",
           scene::with_camera_tables(
               scene::keys("name video flight mask first_frame frame_count frame_rate_hz weight "
                           "lens camera motion light"),
               {"realism", "occluder"}))) {
    refuse_twice(backgrounds, table, "tables [[background]]");
    catalogue.backgrounds.push_back(background_from(table));
  }
  for (const TableReader& table : root.tables("aircraft", {"name", "aircraft"})) {
    refuse_twice(aircraft, table, "tables [[aircraft]]");
    catalogue.aircraft.push_back(
        {required_name(table), scene::aircraft_in(table), table.where("aircraft")});
  }
  for (const TableReader& table : root.tables(
           "trajectory",
           scene::keys("name waypoints_ned_m times_s speed_mps encounter seen frame_count"))) {
    refuse_twice(trajectories, table, "tables [[trajectory]]");
    catalogue.trajectories.push_back(trajectory_from(table));
  }
}

// The rules by which sequences are made from the parts.
void add_rules(const TableReader& root, Catalogue& catalogue) {
  std::set<std::string> names;
  for (const TableReader& table :
       root.tables("sequence", {"name", "background", "trajectory", "aircraft", "frame_count"})) {
    refuse_twice(names, table, "sequences");
    catalogue.rules.emplace_back(listed_from(table, catalogue));
  }
  for (const TableReader& table :
       root.tables("product",
                   {"name", "backgrounds", "trajectories", "aircraft", "frame_count", "negatives"}))
    catalogue.rules.emplace_back(product_from(table, catalogue));
  for (const Drawn& rule : drawn_rules(root, catalogue)) catalogue.rules.emplace_back(rule);
  for (EncounterRule& rule : encounter_rules(root, catalogue))
    catalogue.rules.emplace_back(std::move(rule));
  if (catalogue.rules.empty())
    throw Error(
        "makes no sequence; expected [[sequence]], [[product]], [[random]] or "
        "[[encounter_model]]",
        {catalogue.file.string()});
}

StreamTable stream_in(const TableReader& root) {
  constexpr std::int64_t kMostFrames = 64;  // chosen: two seconds
  constexpr std::int64_t kMostReuse = 1000;
  constexpr std::int64_t kMostMemory_mb = 1'000'000;
  constexpr scene::Limits kSide{"a side in pixels, 16 to 16384", 16, 16384};
  const TableReader table = root.table(
      "stream",
      scene::keys("picture size_px frames intruders masks other_cameras reuse memory_mb"));
  StreamTable stream;
  if (table.choice("picture", {"crop", "frame"}).value_or("crop") == "crop") {
    const auto size =
        table.tuple("size_px", {kSide, kSide}).value_or(std::vector<double>{256, 256});
    stream.crop_px = {static_cast<int>(size[0]), static_cast<int>(size[1])};
    if ((*stream.crop_px)[0] != size[0] || (*stream.crop_px)[1] != size[1])
      table.fail("size_px", "size_px is no whole number of pixels; expected whole numbers");
  } else if (table.has("size_px")) {
    table.fail("size_px", "size_px is for picture = \"crop\"; a frame has its own size");
  }
  stream.frames = table.whole("frames", 1, kMostFrames).value_or(stream.frames);
  stream.intruders = whole_range(table, "intruders", kMaxIntruders);
  stream.masks = table.truth("masks").value_or(stream.masks);
  stream.other_cameras =
      table.number("other_cameras", scene::kShare).value_or(stream.other_cameras);
  stream.reuse = table.whole("reuse", 1, kMostReuse).value_or(stream.reuse);
  stream.memory_mb = table.whole("memory_mb", 1, kMostMemory_mb).value_or(stream.memory_mb);
  return stream;
}

}  // namespace

std::int64_t end_of(const Background& background, std::int64_t frames) {
  if (!background.frame_count) return frames;
  const std::int64_t end = background.first_frame + *background.frame_count;
  return frames > 0 ? std::min(frames, end) : end;
}

Catalogue read_catalogue(const fs::path& file) {
  return parse_catalogue(read_file(file, scene::kLargestToml), file);
}

Catalogue parse_catalogue(std::string_view text, const fs::path& file) {
  const toml::table parsed = scene::parsed_toml(text, file.string());
  const TableReader root(
      parsed,
      "a catalogue",
      file.string(),
      scene::keys("name seed background aircraft trajectory sequence product random "
                  "encounter_model distractor negatives truth render composite output "
                  "stream slurm"));
  Catalogue catalogue;
  catalogue.file = file;
  catalogue.text = text;
  catalogue.name = root.file_name("name").value_or(file.stem().string());
  catalogue.seed = static_cast<std::uint64_t>(
      root.whole("seed", 0, std::numeric_limits<std::int64_t>::max()).value_or(1));
  static_cast<scene::OutputTables&>(catalogue) = scene::output_tables_in(root);
  catalogue.stream = stream_in(root);
  catalogue.slurm = slurm_in(root);
  catalogue.negatives = root.number("negatives", scene::kShare).value_or(0);
  add_parts(root, catalogue);
  add_rules(root, catalogue);
  catalogue.distractors = distractor_rules(root);
  return catalogue;
}

}  // namespace airtruth::catalogue
