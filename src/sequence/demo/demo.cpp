// SPDX-License-Identifier: Apache-2.0
#include "sequence/demo/demo.h"

#include <cmath>
#include <memory>

#include <fmt/format.h>
#include <tbb/info.h>
#include <tbb/parallel_pipeline.h>

#include "foundation/base/error.h"
#include "foundation/base/file_state.h"
#include "picture/video/still.h"
#include "sequence/insertion/masks.h"
#include "sequence/replay/finished.h"

namespace airtruth::demo {
namespace {

video::StreamInfo stream_of(const synthetic::FlightOptions& options, const image::Picture& first) {
  video::StreamInfo info;
  info.width = options.width;
  info.height = options.height;
  info.colour = first.colour;
  // The rate as it is stated, but 29.97 and its like, to three decimals, are n 1000/1001.
  const double hz = options.frame_rate_hz;
  const auto off = [hz](int den) { return std::abs(hz - std::round(hz * den) / den); };
  const bool is_ntsc = std::lround(hz * 1001) % 1000 == 0;
  const int den = off(1) < 1e-9 ? 1 : !is_ntsc && off(1000) < off(1001) ? 1000 : 1001;
  info.frame_rate = {static_cast<int>(std::lround(hz * den)), den};
  info.time_base = {info.frame_rate.den, info.frame_rate.num};
  info.frame_count_estimate = options.frame_count;
  return info;
}

}  // namespace

void write_flight(const synthetic::Flight& flight,
                  const fs::path& out,
                  const VirtualFlightOptions& options) {
  const synthetic::FlightOptions& what = flight.options();
  video::Writer writer(out,
                       stream_of(what, flight.frame(0)),
                       {.format = options.format, .quality = options.quality});
  using FramePtr = std::shared_ptr<video::Frame>;
  int next = 0;
  const auto in_flight = static_cast<std::size_t>(tbb::info::default_concurrency()) + 2;
  tbb::parallel_pipeline(
      in_flight,
      tbb::make_filter<void, int>(tbb::filter_mode::serial_in_order,
                                  [&](tbb::flow_control& control) {
                                    if (next == what.frame_count || options.stop.stop_requested())
                                      control.stop();
                                    return next++;
                                  }) &
          tbb::make_filter<int, FramePtr>(tbb::filter_mode::parallel,
                                          [&](int index) {
                                            auto frame = std::make_shared<video::Frame>();
                                            frame->index = index;
                                            frame->pts = index;
                                            frame->time_s = index / what.frame_rate_hz;
                                            frame->picture = flight.frame(index);
                                            return frame;
                                          }) &
          tbb::make_filter<FramePtr, void>(tbb::filter_mode::serial_in_order,
                                           [&](const FramePtr& frame) {
                                             writer.write(*frame);
                                             if (options.progress)
                                               options.progress(frame->index + 1, what.frame_count);
                                           }));
  if (options.stop.stop_requested()) throw Interrupted();
  writer.finish();
}

namespace {

// A Boeing 737 crosses from left to right and a Cessna overtakes on the right, both within a
// kilometre.
constexpr const char* kScene =
    R"(# Made by `airtruth demo`; change it and run: airtruth render demo.toml --out . --overwrite
name = "demo"
seed = {}

[background]
video = "flight.mp4"
mask = "own_aircraft.png"

[lens]
model = "fisheye"
vertical_fov_deg = {:g}

[camera]
position_ned_m = [0, 0, -{:g}]
velocity_ned_mps = [{:g}, 0, 0]
attitude_yaw_pitch_roll_deg = [0, 0, 0]

[motion]
reference = "first_frame"

[light]
sun_azimuth_deg = {:g}
sun_elevation_deg = {:g}

[[intruder]]
id = "b737"
aircraft = "738/738-Ryanair"
waypoints_ned_m = [[330, -420, -290], [420, -60, -262], [560, 380, -250], [700, 900, -245]]
speed_mps = 95

[[intruder]]
id = "c172"
aircraft = "c172/news"
waypoints_ned_m = [[70, 60, -172], [290, 62, -190], [900, 40, -230]]
speed_mps = 52

[output]
video = "mp4"
quality = 18
)";

// Vertical field of view of the demo's fisheye lens: a choice.
constexpr double kVerticalFovDeg = 100;

synthetic::FlightOptions flight_options(const DemoOptions& options) {
  synthetic::FlightOptions flight{.seed = options.seed, .frame_count = options.frame_count};
  flight.lens = lens::fisheye_from_vertical_fov(kVerticalFovDeg, {flight.width, flight.height});
  return flight;
}

std::string scene_text(const synthetic::FlightOptions& flight, std::uint64_t seed) {
  return fmt::format(kScene,
                     seed,
                     kVerticalFovDeg,
                     flight.altitude_m,
                     flight.speed_mps,
                     flight.sun_azimuth_deg,
                     flight.sun_elevation_deg);
}

std::function<void(std::int64_t, std::int64_t)> staged(const pipeline::Options& run,
                                                       const char* stage) {
  if (!run.progress) return {};
  return [&run, stage](std::int64_t done, std::int64_t total) {
    run.progress({done, total, stage});
  };
}

}  // namespace

pipeline::Summary make_demo(const fs::path& out, const DemoOptions& options) {
  const pipeline::Options& run = options.run;
  for (const char* name :
       {"demo", "flight.mp4", "flight.csv", "own_aircraft.png", "demo.toml", "overlay.mp4"})
    refuse_existing(out / name, run.overwrite);
  make_folders(out);
  const RunLock lock(out, out, run.warn);
  const synthetic::Flight flight(flight_options(options));
  write_flight(flight, out / "flight.mp4", {.stop = run.stop, .progress = staged(run, "flying")});
  write_file(out / "flight.csv", synthetic::csv_from_flight(flight));
  video::write_still(out / "own_aircraft.png", insertion::picture_of(flight.own_aircraft()));
  write_file(out / "demo.toml", scene_text(flight.options(), options.seed));
  const pipeline::Summary summary =
      pipeline::render(scene::read_scene(out / "demo.toml"), out, run);
  replay::write_overlay(replay::open_finished(summary.folder),
                        out / "overlay.mp4",
                        {.overwrite = true, .stop = run.stop, .progress = staged(run, "overlay")});
  return summary;
}

}  // namespace airtruth::demo
