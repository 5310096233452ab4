// SPDX-License-Identifier: Apache-2.0
#include "scene/synthetic/flight.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include "foundation/base/error.h"
#include "foundation/base/seed.h"
#include "scene/synthetic/clouds.h"
#include "scene/synthetic/clutter.h"
#include "scene/synthetic/flight_path.h"
#include "scene/synthetic/ground.h"
#include "scene/synthetic/own_aircraft.h"
#include "scene/synthetic/panorama.h"
#include "scene/synthetic/sensor.h"

namespace airtruth::synthetic {
namespace {

void require(bool good, std::string_view name, double value, std::string_view expected) {
  if (!good)
    throw Error(fmt::format("virtual flight: {} is {}; expected {}", name, value, expected));
}

void check_lens(const FlightOptions& o) {
  if (o.lens && !(o.lens->size() == lens::ImageSize{o.width, o.height}))
    throw Error(
        fmt::format("virtual flight: the lens is for {} x {} px; expected the picture's {} x {}",
                    o.lens->size().width,
                    o.lens->size().height,
                    o.width,
                    o.height));
}

const FlightOptions& validated(const FlightOptions& o) {
  require(o.width >= 16 && o.width <= 16384, "width", o.width, "16 to 16384 px");
  require(o.height >= 16 && o.height <= 16384, "height", o.height, "16 to 16384 px");
  require(o.frame_rate_hz > 0 && o.frame_rate_hz <= 1000,
          "frame rate",
          o.frame_rate_hz,
          "more than 0, at most 1000 Hz");
  require(o.frame_count >= 1, "frame count", o.frame_count, "at least 1");
  require(o.altitude_m >= 20 && o.altitude_m <= 900,
          "altitude",
          o.altitude_m,
          "20 to 900 m (below the clouds)");
  require(o.speed_mps >= 0 && o.speed_mps <= 400, "speed", o.speed_mps, "0 to 400 m/s");
  require(std::isfinite(o.heading_deg), "heading", o.heading_deg, "a number");
  require(std::isfinite(o.sun_azimuth_deg), "sun azimuth", o.sun_azimuth_deg, "a number");
  require(o.sun_elevation_deg >= 2 && o.sun_elevation_deg <= 90,
          "sun elevation",
          o.sun_elevation_deg,
          "2 to 90 deg");
  require(o.cloud_cover >= 0 && o.cloud_cover <= 1, "cloud cover", o.cloud_cover, "0 to 1");
  require(o.hills_deg >= 0 && o.hills_deg <= 5, "hills", o.hills_deg, "0 to 5 deg");
  require(o.extinction_per_km >= 0 && o.extinction_per_km <= 10,
          "extinction",
          o.extinction_per_km,
          "0 to 10 per km");
  require(o.shake_deg >= 0 && o.shake_deg <= 5, "shake", o.shake_deg, "0 to 5 deg");
  require(std::abs(o.roll_deg) <= 45, "roll", o.roll_deg, "-45 to 45 deg");
  require(o.noise >= 0 && o.noise <= 20, "noise", o.noise, "0 to 20");
  require(o.clutter >= 0 && o.clutter <= 1, "clutter", o.clutter, "0 to 1");
  check_lens(o);
  return o;
}

lens::Lens lens_of(const FlightOptions& o) {
  return o.lens ? *o.lens
                : lens::pinhole_from_vertical_fov(o.vertical_fov_deg, {o.width, o.height});
}

std::uint32_t stream(const FlightOptions& o, std::string_view name) {
  return static_cast<std::uint32_t>(Seed(o.seed).stream(name)());
}

// Rays through the pixels' centres in the body's axes, with the lens's fall-off of light, 0 to 1,
// as their fourth number. Beyond the lens's field a ray has no meaning; such pixels are black.
std::vector<Ray> rays_of(const lens::Lens& lens, bool falls_off) {
  const int width = lens.size().width;
  const int height = lens.size().height;
  const Quaternion body_from_cam = cam_from_body().conjugate();
  const Pixel middle(0.5 * width, 0.5 * height);
  std::vector<Ray> rays(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  tbb::parallel_for(0, height, [&](int y) {
    for (int x = 0; x < width; ++x) {
      const Pixel pixel(x + 0.5, y + 0.5);
      const Vector3 ray = body_from_cam * lens.ray_from_pixel(pixel).value_or(Vector3(0, 0, 1));
      const double off_centre = (pixel - middle).squaredNorm() / middle.squaredNorm();
      const double fall_off = 1 - 0.26 * off_centre - 0.08 * off_centre * off_centre;
      rays[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(x)] = {static_cast<float>(ray.x()),
                                           static_cast<float>(ray.y()),
                                           static_cast<float>(ray.z()),
                                           falls_off ? static_cast<float>(fall_off) : 1.0F};
    }
  });
  return rays;
}

// Carries rays from the body's axes into the world; the fourth number is lost.
class Turn {
 public:
  explicit Turn(const Quaternion& world_from_body) {
    const Eigen::Matrix3f turn = world_from_body.toRotationMatrix().cast<float>();
    for (int i = 0; i < 3; ++i) columns_[static_cast<std::size_t>(i)] << turn.col(i).array(), 0;
  }
  Ray operator()(const Ray& ray) const {
    return columns_[0] * ray[0] + columns_[1] * ray[1] + columns_[2] * ray[2];
  }

 private:
  std::array<Ray, 3> columns_;
};

}  // namespace

struct Flight::Impl {
  explicit Impl(const FlightOptions& o)
      : options(validated(o)),
        lens(lens_of(o)),
        path(o),
        sky(sun_in_world(o.sun_azimuth_deg, o.sun_elevation_deg)),
        own(draw_own_aircraft(lens,
                              sun_in_world(o.sun_azimuth_deg - o.heading_deg, o.sun_elevation_deg),
                              sky,
                              o.own_aircraft)),
        rays_in_body(rays_of(lens, !o.linear_light)),
        clouds(sky, o.cloud_cover, stream(o, "clouds")),
        // The panorama's texels at the horizon are finer than pixels by a quarter.
        panorama(0.8 / lens.focal_px()),
        sensor(o, stream(o, "sensor")),
        clutter(o.width, o.height, o.clutter, stream(o, "clutter")),
        ground(o.altitude_m,
               1 / lens.focal_px(),
               o.extinction_per_km,
               sky,
               clouds,
               stream(o, "ground")) {
    draw_panorama();
    Random random = Seed(o.seed).stream("start");
    start_in_land_m = {random.uniform(0, kLand_m), random.uniform(0, kLand_m), 0};
  }

  // What changes from frame to frame.
  struct Moment {
    Turn world_from_body;
    Eye eye;
    std::vector<Clutter::Disc> discs;
  };
  Moment moment(int index) const;
  void draw_panorama();
  LinearRgb seen(const Ray& ray, const Eye& eye) const;
  LightRow row(int y, const Moment& moment) const;
  std::size_t pixel_index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(options.width) +
           static_cast<std::size_t>(x);
  }
  void check_index(int index) const {
    check(index >= 0 && index < options.frame_count, "a frame outside the flight was asked for");
  }

  FlightOptions options;
  lens::Lens lens;
  FlightPath path;
  Sky sky;
  OwnAircraft own;
  std::vector<Ray> rays_in_body;
  Clouds clouds;
  Panorama panorama;
  Sensor sensor;
  Clutter clutter;
  Vector3 start_in_land_m = Vector3::Zero();
  Ground ground;
};

// Draws sky and clouds in the directions that some frame looks at.
void Flight::Impl::draw_panorama() {
  constexpr int kStride = 16;
  for (int k = 0; k < options.frame_count; ++k) {
    const Turn world_from_body(path.shaken(k).world_from_body);
    for (int y = 0; y < options.height + kStride; y += kStride)
      for (int x = 0; x < options.width + kStride; x += kStride) {
        const Ray ray = world_from_body(rays_in_body[pixel_index(std::min(x, options.width - 1),
                                                                 std::min(y, options.height - 1))]);
        panorama.want(ray[0], ray[1], -ray[2]);
      }
  }
  panorama.draw(
      sky, clouds, {options.hills_deg, options.extinction_per_km}, stream(options, "hills"));
}

Flight::Impl::Moment Flight::Impl::moment(int index) const {
  const trajectory::State state = path.shaken(index);
  const Vector3 eye = start_in_land_m + state.position_in_world;
  return {Turn(state.world_from_body),
          {static_cast<float>(eye.x()), static_cast<float>(eye.y()), static_cast<float>(-eye.z())},
          clutter.at(index / options.frame_rate_hz)};
}

// The world along a ray. Pixels that the horizon crosses blend ground and sky.
LinearRgb Flight::Impl::seen(const Ray& ray, const Eye& eye) const {
  const float sky_share = static_cast<float>(lens.focal_px()) * -ray[2] + 0.5F;
  if (sky_share >= 1) return panorama.at(ray[0], ray[1], -ray[2]);
  const Ray down(ray[0], ray[1], std::max(ray[2], 1e-5F), 0);
  const LinearRgb light = ground.seen(eye, down);
  if (sky_share <= 0) return light;
  return light + (panorama.at(ray[0], ray[1], -ray[2]) - light) * sky_share;
}

LightRow Flight::Impl::row(int y, const Moment& moment) const {
  LightRow light(static_cast<std::size_t>(options.width), LinearRgb::Zero());
  const std::size_t first = pixel_index(0, y);
  for (std::size_t x = 0; x < light.size(); ++x)
    if (own.layer[first + x][3] < 1)
      light[x] = seen(moment.world_from_body(rays_in_body[first + x]), moment.eye);
  Clutter::draw(moment.discs, y, light);
  for (std::size_t x = 0; x < light.size(); ++x) {
    const LinearRgb& over = own.layer[first + x];
    light[x] = (light[x] * (1 - over[3]) + over) * rays_in_body[first + x][3];
  }
  return light;
}

Flight::Flight(const FlightOptions& options) : impl_(std::make_unique<Impl>(options)) {}
Flight::~Flight() = default;
Flight::Flight(Flight&&) noexcept = default;

image::Picture Flight::frame(int index) const {
  impl_->check_index(index);
  const int height = impl_->options.height;
  image::Picture picture = image::make_picture(impl_->options.width, height, image::Colour{});
  const Impl::Moment moment = impl_->moment(index);
  Sensor::Exposure exposure = impl_->sensor.start();
  tbb::parallel_for(0, (height + 1) / 2, [&](int pair) {
    const int y = 2 * pair;
    LightRow upper = impl_->row(y, moment);
    LightRow lower = y + 1 < height ? impl_->row(y + 1, moment) : upper;
    impl_->sensor.expose(index, y, std::move(upper), std::move(lower), exposure, picture);
  });
  tbb::parallel_for(0, height, [&](int y) { impl_->sensor.sharpen(exposure, y, picture); });
  return picture;
}

trajectory::State Flight::camera(int index) const { return impl_->path.shaken(index); }
trajectory::State Flight::nominal_camera(int index) const { return impl_->path.nominal(index); }
const image::Mask& Flight::own_aircraft() const { return impl_->own.mask; }
const lens::Lens& Flight::lens() const { return impl_->lens; }
const FlightOptions& Flight::options() const { return impl_->options; }

Homography Flight::frame_from_first(int index) const {
  const auto* pinhole = std::get_if<lens::Pinhole>(&impl_->lens.model());
  check(pinhole != nullptr, "frame_from_first needs a pinhole");
  Matrix3 pixel_from_cam = Matrix3::Identity();
  pixel_from_cam(0, 0) = pinhole->focal_px.x();
  pixel_from_cam(1, 1) = pinhole->focal_px.y();
  pixel_from_cam(0, 2) = pinhole->principal_point_px.x();
  pixel_from_cam(1, 2) = pinhole->principal_point_px.y();
  const auto cam_from_world = [&](int k) {
    return (cam_from_body() * camera(k).world_from_body.conjugate()).toRotationMatrix();
  };
  const Homography h = pixel_from_cam * cam_from_world(index) * cam_from_world(0).transpose() *
                       pixel_from_cam.inverse();
  return h / h(2, 2);
}

std::string csv_from_flight(const Flight& flight) {
  std::string text =
      "frame,time_s,north_m,east_m,down_m,yaw_deg,pitch_deg,roll_deg,"
      "nominal_north_m,nominal_east_m,nominal_down_m,nominal_yaw_deg,nominal_pitch_deg,nominal_"
      "roll_deg\n";
  const auto append = [&](const trajectory::State& s) {
    const YawPitchRoll a = yaw_pitch_roll(s.world_from_body);
    text += fmt::format(",{},{},{},{},{},{}",
                        s.position_in_world.x(),
                        s.position_in_world.y(),
                        s.position_in_world.z(),
                        a.yaw_deg,
                        a.pitch_deg,
                        a.roll_deg);
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
