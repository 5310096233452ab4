// SPDX-License-Identifier: Apache-2.0
#include "scene/synthetic/flight.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <tbb/parallel_for.h>

#include "foundation/base/error.h"
#include "foundation/base/seed.h"
#include "foundation/geometry/units.h"
#include "scene/synthetic/row_painter.h"
#include "scene/synthetic/sensor.h"

namespace airtruth::synthetic {
namespace {

const FlightOptions& validated(const FlightOptions& o) {
  struct Limits {
    std::string_view name;
    double value, low, high;
    std::string_view expected;
  };
  constexpr double kAny = std::numeric_limits<double>::max();
  const Limits all[] = {
      {"width", double(o.width), 16, 16384, "16 to 16384 px"},
      {"height", double(o.height), 16, 16384, "16 to 16384 px"},
      {"frame rate", o.frame_rate_hz, 1e-300, 1000, "more than 0, at most 1000 Hz"},
      {"frame count", double(o.frame_count), 1, kAny, "at least 1"},
      {"altitude", o.altitude_m, 20, 900, "20 to 900 m (below the clouds)"},
      {"speed", o.speed_mps, 0, 400, "0 to 400 m/s"},
      {"heading", o.heading_deg, -kAny, kAny, "a number"},
      {"sun azimuth", o.sun_azimuth_deg, -kAny, kAny, "a number"},
      {"sun elevation", o.sun_elevation_deg, 2, 90, "2 to 90 deg"},
      {"cloud cover", o.cloud_cover, 0, 1, "0 to 1"},
      {"hills", o.hills_deg, 0, 5, "0 to 5 deg"},
      {"extinction", o.extinction_per_km, 0, 10, "0 to 10 per km"},
      {"shake", o.shake_deg, 0, 5, "0 to 5 deg"},
      {"roll", o.roll_deg, -45, 45, "-45 to 45 deg"},
      {"noise", o.noise, 0, 20, "0 to 20"},
      {"clutter", o.clutter, 0, 1, "0 to 1"},
  };
  for (const Limits& limits : all)
    if (!(limits.value >= limits.low && limits.value <= limits.high))
      throw Error(fmt::format(
          "virtual flight: {} is {}; expected {}", limits.name, limits.value, limits.expected));
  if (o.lens && !(o.lens->size() == lens::ImageSize{o.width, o.height}))
    throw Error(
        fmt::format("virtual flight: the lens is for {} x {} px; expected the picture's {} x {}",
                    o.lens->size().width,
                    o.lens->size().height,
                    o.width,
                    o.height));
  return o;
}

lens::Lens lens_of(const FlightOptions& o) {
  return o.lens ? *o.lens
                : lens::pinhole_from_vertical_fov(o.vertical_fov_deg, {o.width, o.height});
}

std::uint32_t stream(const FlightOptions& o, std::string_view name) {
  return static_cast<std::uint32_t>(Seed(o.seed).stream(name)());
}

// Where a constant of this file states no origin, it is a choice: the world is invented.

// Number of texels of the panorama at the horizon for a pixel in the middle of the picture.
constexpr double kPanoramaOversampling = 1.25;
// Number of rows of a parallel task; even, since rows are exposed in pairs.
constexpr int kRowsPerTask = 8;

// The slow motions of the flight beside its vibration.
constexpr double kRollPeriod_s = 8.5;
constexpr double kPitchPeriod_s = 6.1;
constexpr double kPitchAmplitude_deg = 0.7;

// Tones of equal power from 5 to 15 Hz, one in each band.
class Vibration {
 public:
  Vibration(Random random, double rms_deg) {
    for (int i = 0; i < kTones; ++i) {
      Tone& tone = tones_[static_cast<std::size_t>(i)];
      tone.frequency_hz = 5 + 10 * (i + random.uniform()) / kTones;
      tone.phase_rad = random.uniform(0, 2 * kPi);
      tone.amplitude_deg = rms_deg * std::sqrt(2.0 / kTones);
    }
  }
  double at(double time_s) const {
    double total = 0;
    for (const Tone& tone : tones_)
      total += tone.amplitude_deg * std::sin(2 * kPi * tone.frequency_hz * time_s + tone.phase_rad);
    return total;
  }

 private:
  static constexpr int kTones = 7;
  struct Tone {
    double frequency_hz, phase_rad, amplitude_deg;
  };
  std::array<Tone, kTones> tones_{};
};

// The pose of the camera and its shake. Both are closed forms of time, so that frames can be
// computed in any order.
class FlightPath {
 public:
  explicit FlightPath(const FlightOptions& options)
      : options_(options),
        pitch_(Seed(options.seed).stream("shake.pitch"), options.shake_deg),
        yaw_(Seed(options.seed).stream("shake.yaw"), options.shake_deg),
        roll_(Seed(options.seed).stream("shake.roll"), 0.6 * options.shake_deg) {
    Random random = Seed(options.seed).stream("flight");
    roll_phase_rad_ = random.uniform(0, 2 * kPi);
    pitch_phase_rad_ = random.uniform(0, 2 * kPi);
  }

  trajectory::State nominal(int index) const {
    const double time_s = index / options_.frame_rate_hz;
    const double rate = 2 * kPi / kRollPeriod_s;
    const double roll_deg = options_.roll_deg * std::sin(rate * time_s + roll_phase_rad_);
    // A coordinated turn: yaw rate = g tan(roll) / speed, integrated for the small sinusoidal roll.
    const double turn = options_.speed_mps > 1 ? kStandardGravityMps2 / options_.speed_mps : 0.0;
    const double yaw_deg = options_.heading_deg + std::min(turn, 0.5) * options_.roll_deg / rate *
                                                      (std::cos(roll_phase_rad_) -
                                                       std::cos(rate * time_s + roll_phase_rad_));
    const double pitch_deg =
        kPitchAmplitude_deg * std::sin(2 * kPi * time_s / kPitchPeriod_s + pitch_phase_rad_);
    trajectory::State state;
    const double heading = radians(options_.heading_deg);
    const double travel_m = options_.translate ? options_.speed_mps * time_s : 0.0;
    const Vector3 ahead(std::cos(heading), std::sin(heading), 0);
    state.position_in_world = travel_m * ahead - Vector3(0, 0, options_.altitude_m);
    state.velocity_in_world_mps = (options_.translate ? options_.speed_mps : 0.0) * ahead;
    state.world_from_body = world_from_body({yaw_deg, pitch_deg, roll_deg});
    return state;
  }

  trajectory::State shaken(int index) const {
    trajectory::State state = nominal(index);
    const double time_s = index / options_.frame_rate_hz;
    const YawPitchRoll shake{yaw_.at(time_s), pitch_.at(time_s), roll_.at(time_s)};
    state.world_from_body = (state.world_from_body * world_from_body(shake)).normalized();
    return state;
  }

 private:
  FlightOptions options_;
  Vibration pitch_, yaw_, roll_;
  double roll_phase_rad_ = 0;
  double pitch_phase_rad_ = 0;
};

}  // namespace

struct Flight::Impl {
  explicit Impl(const FlightOptions& o)
      : options(validated(o)),
        lens(lens_of(o)),
        path(o),
        sky(unit_vector(o.sun_azimuth_deg, o.sun_elevation_deg)),
        own(draw_own_aircraft(lens,
                              unit_vector(o.sun_azimuth_deg - o.heading_deg, o.sun_elevation_deg),
                              sky,
                              o.own_aircraft)),
        view(lens, !o.linear_light),
        panorama(1 / (lens.focal_px() * kPanoramaOversampling)),
        sensor(o, stream(o, "sensor")),
        ground(make_world()) {}

  Ground make_world();
  Moment moment(int index) const;

  FlightOptions options;
  lens::Lens lens;
  FlightPath path;
  Sky sky;
  OwnAircraft own;
  RayTable view;
  Panorama panorama;
  Sensor sensor;
  Vector3 start_in_land_m = Vector3::Zero();
  Ground ground;
};

// Draws sky and clouds in the directions that some frame looks at, and passes the clouds' shadow to
// the ground.
Ground Flight::Impl::make_world() {
  for (int k = 0; k < options.frame_count; ++k)
    for (const RayNode& d : view.directions_in_world(path.shaken(k).world_from_body, 4))
      panorama.want(d[0], d[1], -d[2]);
  const Clouds clouds(sky, options.cloud_cover, stream(options, "clouds"));
  panorama.draw(
      sky, clouds, {options.hills_deg, options.extinction_per_km}, stream(options, "hills"));
  Random random = Seed(options.seed).stream("start");
  start_in_land_m = {random.uniform(0, kLand_m), random.uniform(0, kLand_m), 0};
  const double pixel_rad = 1 / lens.focal_px();
  return {options.altitude_m * pixel_rad * 4,
          pixel_rad,
          options.extinction_per_km,
          sky,
          clouds,
          stream(options, "ground")};
}

Moment Flight::Impl::moment(int index) const {
  const trajectory::State state = path.shaken(index);
  const Vector3 eye = start_in_land_m + state.position_in_world;
  return {
      view.directions_in_world(state.world_from_body, 1),
      {static_cast<float>(eye.x()), static_cast<float>(eye.y()), static_cast<float>(-eye.z())},
      clutter_at(
          index / options.frame_rate_hz, lens.size(), options.clutter, stream(options, "clutter"))};
}

Flight::Flight(const FlightOptions& options) : impl_(std::make_unique<Impl>(options)) {}
Flight::~Flight() = default;
Flight::Flight(Flight&&) noexcept = default;

image::Picture Flight::frame(int index) const {
  check(index >= 0 && index < impl_->options.frame_count,
        "a frame outside the flight was asked for");
  const int width = impl_->options.width;
  const int height = impl_->options.height;
  image::Picture picture = image::make_picture(width, height, image::Colour{});
  const Moment moment = impl_->moment(index);
  const Scenery scenery{impl_->view,
                        impl_->panorama,
                        impl_->ground,
                        impl_->own,
                        static_cast<float>(impl_->lens.focal_px())};
  Sensor::Exposure exposure(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  const int tasks = (height + kRowsPerTask - 1) / kRowsPerTask;
  tbb::parallel_for(0, tasks, [&](int task) {
    Row upper(width);
    Row lower(width);
    for (int y = task * kRowsPerTask; y < std::min((task + 1) * kRowsPerTask, height); y += 2) {
      paint_row(scenery, y, moment, upper);
      if (y + 1 < height) paint_row(scenery, y + 1, moment, lower);
      impl_->sensor.expose(index, y, upper, y + 1 < height ? lower : upper, exposure, picture);
    }
  });
  tbb::parallel_for(0, height, [&](int y) { impl_->sensor.sharpen(exposure, y, picture); });
  return picture;
}

trajectory::State Flight::camera(int index) const { return impl_->path.shaken(index); }
trajectory::State Flight::nominal_camera(int index) const { return impl_->path.nominal(index); }
const image::Mask& Flight::own_aircraft() const { return impl_->own.mask; }
const lens::Lens& Flight::lens() const { return impl_->lens; }
const FlightOptions& Flight::options() const { return impl_->options; }

std::string csv_from_flight(const Flight& flight) {
  std::string text =
      "frame,time_s,north_m,east_m,down_m,yaw_deg,pitch_deg,roll_deg,"
      "nominal_north_m,nominal_east_m,nominal_down_m,nominal_yaw_deg,nominal_pitch_deg,nominal_"
      "roll_deg\n";
  const auto append = [&](const trajectory::State& s) {
    const YawPitchRoll a = yaw_pitch_roll(s.world_from_body);
    text += fmt::format(
        ",{},{},{},{}", fmt::join(s.position_in_world, ","), a.yaw_deg, a.pitch_deg, a.roll_deg);
  };
  for (int k = 0; k < flight.options().frame_count; ++k) {
    text += fmt::format("{},{}", k, k / flight.options().frame_rate_hz);
    append(flight.camera(k));
    append(flight.nominal_camera(k));
    text += '\n';
  }
  return text;
}

}  // namespace airtruth::synthetic
