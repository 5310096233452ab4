// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "camera/lens/lens.h"
#include "foundation/geometry/transform.h"
#include "foundation/image/layer.h"
#include "foundation/image/picture.h"
#include "world/trajectory/path.h"

// Virtual flights: onboard video of a world that is known exactly. Sky with clouds and sun,
// textured ground to a hazy horizon, the own aircraft in view, a camera that flies and shakes,
// sensor noise. A function of a seed and a few parameters; the yardstick of the motion tests and
// the background of `airtruth demo`.
namespace airtruth::synthetic {

struct FlightOptions {
  std::uint64_t seed = 1;
  int width = 1280;
  int height = 960;
  double frame_rate_hz = 30;
  int frame_count = 322;
  // Lens: pinhole by its vertical view, or a given one.
  double vertical_fov_deg = 75;
  std::optional<lens::Lens> lens;
  double speed_mps = 25;
  double altitude_m = 150;
  double heading_deg = 0;
  double sun_azimuth_deg = 120;
  double sun_elevation_deg = 40;
  double cloud_cover = 0.5;             // 0..1
  double hills_deg = 1.1;               // highest of the hills on the horizon; 0 none
  double extinction_per_km = 1.0 / 17;  // of the air before ground and hills, all colours alike
  double shake_deg = 0.35;              // rms of the vibration in pitch and yaw
  double roll_deg = 3;                  // amplitude of the slow rolling of the flight
  bool own_aircraft = true;             // nose and wing tips in view
  double noise = 1.0;                   // sensor noise: 1 = a cheap camera; 0 none
  // For the calibration's tests:
  bool ideal_sensor = false;  // no lens blur, no sharpening, no noise
  bool linear_light = false;  // no shoulder, no fall-off to the corners
  double clutter =
      0;  // share of the image's texture that moves on its own (for the motion tests), 0..1
  bool translate = true;  // false: the camera only rotates, so that a homography is exact
};

// Frame by frame, any order, any thread: frame k depends on the options and k alone.
class Flight {
 public:
  explicit Flight(const FlightOptions& options);
  ~Flight();
  Flight(Flight&&) noexcept;

  image::Picture frame(int index) const;  // 4:2:0, BT.601 limited as a cheap camera tags it
  trajectory::State camera(
      int index) const;  // true pose of the camera: position and world_from_body (shaken)
  trajectory::State nominal_camera(int index) const;  // the same without the shake
  const image::Mask& own_aircraft()
      const;  // 0 where the own aircraft, or nothing (beyond the lens), is
  const lens::Lens& lens() const;
  const FlightOptions& options() const;
  // The exact far-field homography frame_from_first: K R_k R_0^-1 K^-1. Pinhole only.
  Homography frame_from_first(int index) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// flight.csv: frame,time_s,north_m,east_m,down_m,yaw_deg,pitch_deg,roll_deg of the true camera, and
// of the nominal one.
std::string csv_from_flight(const Flight& flight);

}  // namespace airtruth::synthetic
