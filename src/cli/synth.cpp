// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "camera/lens/calibration_file.h"
#include "cli/commands.h"
#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/run_files/run_files.h"
#include "picture/video/still.h"
#include "scene/scene/limits.h"
#include "sequence/demo/demo.h"
#include "sequence/insertion/masks.h"

namespace airtruth::cli {
namespace {

struct SynthArguments {
  std::string out;
  std::string truth;
  std::string mask;
  std::string lens_file;
  double duration_s = 0;
  bool no_own_aircraft = false;
  bool rotate_only = false;
  bool overwrite = false;
  int quality = 23;
  synthetic::FlightOptions flight;
};

constexpr int kMaxFrames = 1'000'000;

int frames_of(const SynthArguments& arguments) {
  const double frames = arguments.duration_s * arguments.flight.frame_rate_hz + 0.5;
  if (frames > kMaxFrames)
    throw Error(
        fmt::format("--duration is {:g} s, {:.0f} frames at {:g} a second; expected at most "
                    "{} frames",
                    arguments.duration_s,
                    frames,
                    arguments.flight.frame_rate_hz,
                    kMaxFrames));
  return std::max(1, static_cast<int>(frames));
}

void synth(SynthArguments arguments, Context& context) {
  RunFiles files;
  files.reads(arguments.lens_file);
  files.writes(arguments.truth, arguments.overwrite, {".csv"})
      .writes(arguments.mask, arguments.overwrite, {".png"})
      .writes(arguments.out, arguments.overwrite);
  synthetic::FlightOptions& options = arguments.flight;
  if (arguments.duration_s > 0) options.frame_count = frames_of(arguments);
  options.own_aircraft = !arguments.no_own_aircraft;
  options.translate = !arguments.rotate_only;
  if (!arguments.lens_file.empty())
    options.lens = lens::read_calibration(arguments.lens_file, {options.width, options.height});
  Console& console = context.console();
  const fs::path out = arguments.out;
  demo::VirtualFlightOptions how;
  how.format = video::format_of_file(out);
  how.quality = arguments.quality;
  follow(how, context, "flying");
  const synthetic::Flight flight(options);
  files.begin();
  files.write(out, [&](const fs::path& at) { demo::write_flight(flight, at, how); });
  files.write(arguments.truth,
              [&](const fs::path& at) { write_file(at, synthetic::csv_from_flight(flight)); });
  files.write(arguments.mask, [&](const fs::path& at) {
    video::write_still(at, insertion::picture_of(flight.own_aircraft()));
  });
  files.commit();
  console.result(fmt::format(
      "{}: {} frames of {}x{}", arguments.out, options.frame_count, options.width, options.height));
}

void add_file_options(CLI::App& command, SynthArguments& arguments) {
  command.add_option("-o,--out", arguments.out, "The video to write (.mp4, .mkv or .avi)")
      ->required();
  command.add_option(
      "--truth", arguments.truth, "Write the true camera of every frame here (.csv)");
  command.add_option("--mask", arguments.mask, "Write the own-aircraft mask here (.png)");
}

void add_camera_options(CLI::App& command, SynthArguments& arguments, Context& context) {
  synthetic::FlightOptions& flight = arguments.flight;
  add_number(command, "--width", flight.width, 64, 8192)->description("Pixels");
  add_number(command, "--height", flight.height, 64, 8192)->description("Pixels");
  add_number(command, "--rate", flight.frame_rate_hz, 1.0, 1000.0)->description("Frames a second");
  add_number(command, "--frames", flight.frame_count, 1, kMaxFrames)
      ->description("Number of frames");
  expect_effect(context, command, {"--frames"}, "with --duration", [&arguments] {
    return arguments.duration_s <= 0;
  });
  command.add_option("--duration", arguments.duration_s, "Seconds, in place of --frames")
      ->check(CLI::Range(1e-6, 1e6));
  add_number(command, "--fov", flight.vertical_fov_deg, 1.0, 150.0)
      ->description("Pinhole: vertical view in degrees");
  expect_effect(context, command, {"--fov"}, "with --lens", [&arguments] {
    return arguments.lens_file.empty();
  });
  command.add_option("--lens", arguments.lens_file, "A calibration file, in place of --fov");
}

void add_world_options(CLI::App& command, SynthArguments& arguments) {
  synthetic::FlightOptions& flight = arguments.flight;
  const auto add_limited = [&](const char* name, double& value, const scene::Limits& limits) {
    return add_number(command, name, value, limits.low, limits.high);
  };
  add_limited("--speed", flight.speed_mps, scene::kFlightSpeed)->description("Metres a second");
  add_limited("--altitude", flight.altitude_m, scene::kFlightAltitude)
      ->description("Metres above the ground");
  command.add_option("--sun-azimuth", flight.sun_azimuth_deg, "Degrees from north towards east")
      ->capture_default_str();
  add_limited("--sun-elevation", flight.sun_elevation_deg, scene::kFlightSunElevation)
      ->description("Degrees");
  add_limited("--clouds", flight.cloud_cover, scene::kShare)->description("Cloud cover, 0 to 1");
  add_number(command, "--extinction", flight.extinction_per_km, 0.0, 10.0)
      ->description("Of the air, per km; 0 is none");
}

void add_disturbance_options(CLI::App& command, SynthArguments& arguments) {
  synthetic::FlightOptions& flight = arguments.flight;
  add_number(command, "--shake", flight.shake_deg, 0.0, 5.0)->description("Vibration, degrees rms");
  add_number(command, "--noise", flight.noise, 0.0, 20.0)
      ->description("Sensor noise; 1 is a cheap camera's");
  add_number(command, "--clutter", flight.clutter, 0.0, 1.0)
      ->description("Share of the picture that moves independently, 0 to 1");
  command.add_flag(
      "--no-own-aircraft", arguments.no_own_aircraft, "Leave the own aircraft out of the view");
  command.add_flag("--rotate-only", arguments.rotate_only)
      ->description("The camera turns but does not move, so that a homography is exact");
}

}  // namespace

void add_synth(CLI::App& app, Context& context) {
  auto [command, arguments] = add_command(app, context, "synth", synth);
  command->description("Make a virtual flight: onboard video of a world that is known exactly");
  add_file_options(*command, *arguments);
  command->add_option("--seed", arguments->flight.seed)
      ->description("Of the random numbers: another world and another flight")
      ->capture_default_str();
  add_camera_options(*command, *arguments, context);
  add_world_options(*command, *arguments);
  add_disturbance_options(*command, *arguments);
  add_number(*command, "--quality", arguments->quality, 0, 51)->description("H.264 CRF");
  command->add_flag("--overwrite", arguments->overwrite, "Replace files that exist");
}

}  // namespace airtruth::cli
