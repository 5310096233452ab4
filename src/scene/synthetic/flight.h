// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "camera/lens/lens.h"
#include "foundation/geometry/transform.h"
#include "foundation/image/layer.h"
#include "foundation/image/picture.h"
#include "scene/trajectory/path.h"

// Virtual flights: onboard video of a world that is known exactly. The world has a sky with clouds
// and sun, textured ground up to a hazy horizon and the own aircraft in view; the camera flies and
// shakes, and its sensor adds noise. A flight is a function of its options, the seed included. It
// is the reference of the motion tests and the background of `airtruth demo`.
namespace airtruth::synthetic {

// Options of a virtual flight.
struct FlightOptions {
  std::uint64_t seed = 1;
  int width = 1280;
  int height = 960;
  double frame_rate_hz = 30;
  int frame_count = 322;
  // The lens: a pinhole with this vertical field of view, or the given one.
  double vertical_fov_deg = 75;
  std::optional<lens::Lens> lens;
  double speed_mps = 25;
  double altitude_m = 150;
  double heading_deg = 0;
  double sun_azimuth_deg = 120;
  double sun_elevation_deg = 40;
  // Share of the sky, 0..1.
  double cloud_cover = 0.5;
  // Height of the highest hills on the horizon; 0: none.
  double hills_deg = 1.1;
  // Extinction of the air before ground and hills, equal for all colours.
  double extinction_per_km = 1.0 / 17;
  // Root mean square of the vibration in pitch and yaw.
  double shake_deg = 0.35;
  // Amplitude of the slow rolling of the flight.
  double roll_deg = 3;
  // True: nose and wing tips are in view.
  bool own_aircraft = true;
  // Strength of the sensor noise: 1 is a cheap camera, 0 none.
  double noise = 1.0;
  // Options for the tests of the calibration.
  // True: no lens blur, no sharpening and no noise.
  bool ideal_sensor = false;
  // True: no shoulder of the tone curve and no fall-off to the corners.
  bool linear_light = false;
  // Share of the image's texture that moves independently, 0..1; for the motion tests.
  double clutter = 0;
  // False: the camera only rotates, so that a homography describes its motion exactly.
  bool translate = true;
};

// Throws Error for what Flight refuses.
void check_options(const FlightOptions& options);

// Renders the frames of a flight in any order and on any thread: frame k depends only on the
// options and on k.
class Flight {
 public:
  explicit Flight(const FlightOptions& options);
  ~Flight();
  Flight(Flight&&) noexcept;

  // 4:2:0, tagged as BT.601 limited, as by a cheap camera.
  image::Picture frame(int index) const;
  // True pose of the camera with the shake: position and world_from_body.
  trajectory::State camera(int index) const;
  // The pose without the shake.
  trajectory::State nominal_camera(int index) const;
  // 0 where the own aircraft, or the area beyond the lens's field, is.
  const image::Mask& own_aircraft() const;
  const lens::Lens& lens() const;
  const FlightOptions& options() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// The text of flight.csv: frame,time_s,north_m,east_m,down_m,yaw_deg,pitch_deg,roll_deg of the true
// camera, and those of the nominal one.
std::string csv_from_flight(const Flight& flight);

}  // namespace airtruth::synthetic
