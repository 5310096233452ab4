// SPDX-License-Identifier: Apache-2.0
#include "scene/synthetic/flight.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include <Eigen/Core>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <tbb/parallel_for.h>

#include "foundation/base/error.h"
#include "foundation/base/seed.h"
#include "foundation/geometry/horizon_dip.h"
#include "foundation/geometry/units.h"
#include "scene/scene/limits.h"
#include "scene/synthetic/ground.h"
#include "scene/synthetic/own_aircraft.h"
#include "scene/synthetic/rays.h"
#include "scene/synthetic/sensor.h"
#include "scene/synthetic/sky.h"

namespace airtruth::synthetic {
namespace {

const FlightOptions& validated(const FlightOptions& o) {
  struct Number {
    std::string_view name;
    double value;
    scene::Limits limits;
  };
  constexpr double kAny = std::numeric_limits<double>::max();
  const Number all[] = {
      {"width", double(o.width), {"16 to 16384 px", 16, 16384}},
      {"height", double(o.height), {"16 to 16384 px", 16, 16384}},
      {"frame rate", o.frame_rate_hz, {"more than 0, at most 1000 Hz", 1e-300, 1000}},
      {"frame count", double(o.frame_count), {"at least 1", 1, kAny}},
      {"altitude", o.altitude_m, scene::kFlightAltitude},
      {"speed", o.speed_mps, scene::kFlightSpeed},
      {"heading", o.heading_deg, {"a number", -kAny, kAny}},
      {"sun azimuth", o.sun_azimuth_deg, {"a number", -kAny, kAny}},
      {"sun elevation", o.sun_elevation_deg, scene::kFlightSunElevation},
      {"cloud cover", o.cloud_cover, scene::kShare},
      {"hills", o.hills_deg, {"0 to 5 deg", 0, 5}},
      {"extinction", o.extinction_per_km, {"0 to 10 per km", 0, 10}},
      {"shake", o.shake_deg, {"0 to 5 deg", 0, 5}},
      {"roll", o.roll_deg, {"-45 to 45 deg", -45, 45}},
      {"noise", o.noise, {"0 to 20", 0, 20}},
      {"clutter", o.clutter, scene::kShare},
  };
  for (const Number& number : all)
    if (!number.limits.holds(number.value))
      throw Error(fmt::format("virtual flight: {} is {}; expected {}",
                              number.name,
                              number.value,
                              number.limits.expected));
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
  // The table of the panorama's parts takes 2 GB there.
  constexpr double kLongestPx = 150'000;
  lens::Lens lens =
      o.lens ? *o.lens : lens::pinhole_from_vertical_fov(o.vertical_fov_deg, {o.width, o.height});
  if (!(lens.focal_px() <= kLongestPx))
    throw Error(
        fmt::format("virtual flight: the focal length is {:.0f} px; expected up to {:.0f}: a wider "
                    "view or a smaller picture",
                    lens.focal_px(),
                    kLongestPx));
  return lens;
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

// Unit direction of a ray (x, y, z) and the fall-off of the light of the lens, 0 to 1.
using RayNode = Eigen::Array4f;

// Beyond the lens's field: the last valid ray on the way there. Such pixels are black in the end.
Vector3 ray_or_nearest(const lens::Lens& lens, const Pixel& pixel) {
  if (const auto ray = lens.ray_from_pixel(pixel)) return *ray;
  const Pixel middle(0.5 * lens.size().width, 0.5 * lens.size().height);
  double inside = 0;
  double outside = 1;
  for (int i = 0; i < 30; ++i) {
    const double t = 0.5 * (inside + outside);
    (lens.ray_from_pixel(middle + t * (pixel - middle)) ? inside : outside) = t;
  }
  const auto ray = lens.ray_from_pixel(middle + inside * (pixel - middle));
  return ray ? *ray : Vector3(0, 0, 1);
}

// The lens as a table: rays at nodes every few pixels, with linear interpolation between them
// (within 0.02 px for a lens of 75 degrees). The fourth number of a node is the lens's fall-off of
// light.
class RayTable {
 public:
  // falls_off: true where less light reaches the corners than the middle, as through a cheap lens.
  RayTable(const lens::Lens& lens, bool falls_off)
      : columns_((lens.size().width + kPitch - 1) / kPitch + 1),
        rows_((lens.size().height + kPitch - 1) / kPitch + 1) {
    const Quaternion body_from_cam = cam_from_body().conjugate();
    const Pixel middle(0.5 * lens.size().width, 0.5 * lens.size().height);
    rays_in_body_.reserve(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_));
    for (int row = 0; row < rows_; ++row)
      for (int column = 0; column < columns_; ++column) {
        const Pixel pixel(column * kPitch, row * kPitch);
        const Vector3 ray = body_from_cam * ray_or_nearest(lens, pixel);
        const double off_centre = (pixel - middle).squaredNorm() / middle.squaredNorm();
        RayNode node;
        node.head<3>() = ray.cast<float>().array();
        node[3] = falls_off
                      ? static_cast<float>(1 - 0.26 * off_centre - 0.08 * off_centre * off_centre)
                      : 1.0F;
        rays_in_body_.push_back(node);
      }
  }

  // Rays of every `stride`-th node, rotated into the world.
  std::vector<RayNode> directions_in_world(const Quaternion& world_from_body, int stride) const {
    const Eigen::Matrix3f turn = world_from_body.toRotationMatrix().cast<float>();
    std::vector<RayNode> nodes;
    nodes.reserve(rays_in_body_.size() / static_cast<std::size_t>(stride * stride) + 1);
    for (int row = 0; row < rows_; row += stride)
      for (int column = 0; column < columns_; column += stride) {
        const RayNode& ray = rays_in_body_[static_cast<std::size_t>(row * columns_ + column)];
        RayNode node = ray;
        node.head<3>() = (turn * ray.head<3>().matrix()).array();
        nodes.push_back(node);
      }
    return nodes;
  }

  // Fills in directions and fall-off of the row's pixels. `nodes` are those of stride 1.
  void fill_in(int y, const std::vector<RayNode>& nodes, Row& row) const {
    const float below = (static_cast<float>(y % kPitch) + 0.5F) / kPitch;
    const RayNode* upper = nodes.data() + static_cast<std::ptrdiff_t>(y / kPitch) * columns_;
    const RayNode* lower = upper + columns_;
    RayNode left = upper[0] + (lower[0] - upper[0]) * below;
    for (int column = 0; column + 1 < columns_; ++column) {
      const RayNode right = upper[column + 1] + (lower[column + 1] - upper[column + 1]) * below;
      const RayNode step = (right - left) / kPitch;
      const std::array parts{&row.north, &row.east, &row.down, &row.fall_off};
      for (std::size_t part = 0; part < parts.size(); ++part)
        for (int x = 0; x < kPitch; ++x)
          (*parts[part])[static_cast<std::size_t>(column * kPitch + x)] =
              left[part] + step[part] * (static_cast<float>(x) + 0.5F);
      left = right;
    }
  }

 private:
  // Pixels between two nodes.
  static constexpr int kPitch = 8;

  int columns_;
  int rows_;
  std::vector<RayNode> rays_in_body_;
};

// A mottled disc that moves over the image independently of the camera: motion that a motion
// estimate must reject.
struct Disc {
  float x, y;
  float radius;
  std::uint32_t seed;
};

// What changes from frame to frame.
struct Moment {
  // Rays of the table's nodes in the world.
  std::vector<RayNode> nodes;
  Eye eye;
  std::vector<Disc> discs;
};

// A triangle wave between 0 and 1.
float bounce(double x) {
  const double turn = x - 2 * std::floor(x / 2);
  return static_cast<float>(turn < 1 ? turn : 2 - turn);
}

void draw(const Disc& disc, int y, int width, Row& row) {
  const float dy = static_cast<float>(y) + 0.5F - disc.y;
  if (std::abs(dy) >= disc.radius) return;
  const float reach = std::sqrt(disc.radius * disc.radius - dy * dy);
  const int first = std::max(static_cast<int>(disc.x - reach), 0);
  const int last = std::min(static_cast<int>(disc.x + reach) + 1, width);
  for (int x = first; x < last; ++x) {
    const float dx = static_cast<float>(x) + 0.5F - disc.x;
    const float edge = 1 - std::sqrt(dx * dx + dy * dy) / disc.radius;
    if (edge <= 0) continue;
    const float scale = 4.5F / disc.radius;
    const float mottle = fractal<2>(128, disc.seed).at(dx * scale + 64, dy * scale + 64);
    const LinearRgb tone = linear_rgb(0.75F, 0.72F, 0.66F) * (mottle * mottle * 1.5F);
    const float covered = smoothstep(0.0F, 0.25F, edge);
    const auto i = static_cast<std::size_t>(x);
    row.red[i] += (tone[0] - row.red[i]) * covered;
    row.green[i] += (tone[1] - row.green[i]) * covered;
    row.blue[i] += (tone[2] - row.blue[i]) * covered;
  }
}

// What a pixel sees: only sky and hills, the ground (or the horizon), or nothing but the own
// aircraft.
enum Sees : std::uint8_t { kSky, kGround, kAircraft };

// The discs that cover a share of the image.
std::vector<Disc> clutter_at(double time_s,
                             const lens::ImageSize& size,
                             double share,
                             std::uint32_t seed) {
  std::vector<Disc> discs;
  if (share <= 0) return discs;
  const float radius = 0.032F * static_cast<float>(size.height);
  const double area = 3.14159 * radius * radius;
  const int count =
      std::max(1, static_cast<int>(std::lround(share * size.width * size.height / area)));
  for (int i = 0; i < count; ++i) {
    const std::uint32_t id = hash(i, 0, seed);
    const auto draw = [&](std::uint32_t k) { return unit(mix(id + k)); };
    // One crossing of the image takes 8 to 40 s.
    const double across = time_s * (0.025 + 0.1 * draw(1)) + 2 * draw(2);
    const double along = time_s * (0.025 + 0.1 * draw(3)) + 2 * draw(4);
    discs.push_back({bounce(across) * static_cast<float>(size.width),
                     bounce(along) * static_cast<float>(size.height),
                     radius * (0.7F + 0.6F * draw(5)),
                     id});
  }
  return discs;
}

}  // namespace

void check_options(const FlightOptions& options) { lens_of(validated(options)); }

struct Flight::Impl {
  explicit Impl(const FlightOptions& o)
      : options(validated(o)),
        lens(lens_of(o)),
        focal_px(static_cast<float>(lens.focal_px())),
        path(o),
        sky(unit_vector(o.sun_azimuth_deg, o.sun_elevation_deg)),
        own(draw_own_aircraft(lens,
                              unit_vector(o.sun_azimuth_deg - o.heading_deg, o.sun_elevation_deg),
                              sky,
                              o.own_aircraft)),
        view(lens, !o.linear_light),
        panorama(1 / (lens.focal_px() * kPanoramaOversampling), horizon_dip_rad(o.altitude_m)),
        sensor(o, stream(o, "sensor")),
        ground(make_world()) {}

  // Draws sky and clouds in the directions that some frame looks at, and passes the clouds' shadow
  // to the ground.
  Ground make_world() {
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

  Moment moment_of(int index) const {
    const trajectory::State state = path.shaken(index);
    const Vector3 eye = start_in_land_m + state.position_in_world;
    return {view.directions_in_world(state.world_from_body, 1),
            {static_cast<float>(eye.x()),
             static_cast<float>(eye.y()),
             static_cast<float>(-eye.z()),
             static_cast<float>(std::sin(horizon_dip_rad(-eye.z())))},
            clutter_at(index / options.frame_rate_hz,
                       lens.size(),
                       options.clutter,
                       stream(options, "clutter"))};
  }

  // The height above the horizon in pixels, plus one half: from 0 to 1 a pixel sees both sides.
  float above_horizon(const Eye& eye, float down) const {
    return focal_px * (eye.dip - down) + 0.5F;
  }

  std::vector<Sees> seen_by_pixels(int y, const Eye& eye, const Row& row) const {
    std::vector<Sees> sees(static_cast<std::size_t>(own.mask.width));
    for (std::size_t x = 0; x < sees.size(); ++x)
      sees[x] = above_horizon(eye, row.down[x]) >= 1 ? kSky : kGround;
    const auto line = static_cast<std::size_t>(y);
    const LinearRgb* layer = own.layer.data() + line * sees.size();
    for (int x = own.first[line]; x < own.last[line]; ++x)
      if (layer[x][3] >= 1) sees[static_cast<std::size_t>(x)] = kAircraft;
    return sees;
  }

  // Ground and sky are blended in the pixels that the horizon crosses.
  void paint_run(Sees sees, const Row::Run& pixels, const Eye& eye) const {
    if (sees == kAircraft) return;
    if (sees == kGround) ground.light(eye, pixels);
    for (int i = 0; i < pixels.count; ++i) {
      const float sky_share = above_horizon(eye, pixels.down[i]);
      if (sky_share <= 0) continue;
      const LinearRgb above = panorama.at(pixels.north[i], pixels.east[i], -pixels.down[i]);
      const LinearRgb below = linear_rgb(pixels.red[i], pixels.green[i], pixels.blue[i]);
      const LinearRgb light = sees == kSky ? above : LinearRgb(below + (above - below) * sky_share);
      pixels.red[i] = light[0];
      pixels.green[i] = light[1];
      pixels.blue[i] = light[2];
    }
  }

  void add_own_aircraft(int y, Row& row) const {
    const auto line = static_cast<std::size_t>(y);
    const LinearRgb* layer = own.layer.data() + line * static_cast<std::size_t>(own.mask.width);
    for (int x = own.first[line]; x < own.last[line]; ++x) {
      const LinearRgb& over = layer[x];
      const auto i = static_cast<std::size_t>(x);
      row.red[i] = row.red[i] * (1 - over[3]) + over[0];
      row.green[i] = row.green[i] * (1 - over[3]) + over[1];
      row.blue[i] = row.blue[i] * (1 - over[3]) + over[2];
    }
  }

  void paint_row(int y, const Moment& moment, Row& row) const {
    view.fill_in(y, moment.nodes, row);
    const std::vector<Sees> sees = seen_by_pixels(y, moment.eye, row);
    for (std::size_t first = 0; first < sees.size();) {
      std::size_t end = first + 1;
      while (end < sees.size() && end - first < Row::kRun && sees[end] == sees[first]) ++end;
      paint_run(sees[first], row.run(first, end - first), moment.eye);
      first = end;
    }
    for (const Disc& disc : moment.discs) draw(disc, y, own.mask.width, row);
    add_own_aircraft(y, row);
  }

  image::Picture frame(int index) const {
    check(index >= 0 && index < options.frame_count, "a frame outside the flight was asked for");
    const int width = options.width;
    const int height = options.height;
    image::Picture picture = image::make_picture(width, height, image::Colour{});
    const Moment moment = moment_of(index);
    Sensor::Exposure exposure(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    const int tasks = (height + kRowsPerTask - 1) / kRowsPerTask;
    tbb::parallel_for(0, tasks, [&](int task) {
      Row upper(width);
      Row lower(width);
      for (int y = task * kRowsPerTask; y < std::min((task + 1) * kRowsPerTask, height); y += 2) {
        paint_row(y, moment, upper);
        if (y + 1 < height) paint_row(y + 1, moment, lower);
        sensor.expose(index, y, upper, y + 1 < height ? lower : upper, exposure, picture);
      }
    });
    tbb::parallel_for(0, height, [&](int y) { sensor.sharpen(exposure, y, picture); });
    return picture;
  }

  FlightOptions options;
  lens::Lens lens;
  float focal_px;
  FlightPath path;
  Sky sky;
  OwnAircraft own;
  RayTable view;
  Panorama panorama;
  Sensor sensor;
  Vector3 start_in_land_m = Vector3::Zero();
  Ground ground;
};

Flight::Flight(const FlightOptions& options) : impl_(std::make_unique<Impl>(options)) {}
Flight::~Flight() = default;
Flight::Flight(Flight&&) noexcept = default;

image::Picture Flight::frame(int index) const { return impl_->frame(index); }
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
