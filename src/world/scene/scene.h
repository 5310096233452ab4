// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "foundation/base/error.h"
#include "foundation/geometry/transform.h"

// A scene file as a value: what the user wrote, checked for shape and range, and nothing loaded
// yet. Each struct is a table of the file and each field a key of the same name;
// docs/formats/scene.md describes them. Paths are already resolved against the scene file's folder.
// `where` is where a table stands in the file, for errors that show only later (an unknown
// aircraft, a path that never increases).
namespace airtruth::scene {

namespace fs = std::filesystem;

struct Background {
  fs::path video;
  std::optional<fs::path> mask;
  std::int64_t first_frame = 0;
  std::optional<std::int64_t> frame_count;
  Where where;
};

struct Lens {
  std::string model = "pinhole";  // pinhole | brown_conrady | fisheye
  std::optional<double> vertical_fov_deg;
  std::optional<std::array<double, 2>> focal_px;
  std::optional<std::array<double, 2>> principal_point_px;
  std::vector<double> distortion;
  std::optional<fs::path> file;
  Where where;
};

struct Camera {
  Vector3 position_ned_m{0, 0, -150};
  Vector3 velocity_ned_mps{0, 0, 0};
  YawPitchRoll attitude_yaw_pitch_roll_deg;
  std::optional<fs::path> path_file;
  Where where;
};

struct Motion {
  // auto: rotation, but homography for the method chroma-key
  std::string model = "auto";             // auto | rotation | homography | none
  std::string reference = "first_frame";  // first_frame | smoothed
  double smoothing_s = 1.0;
  Where where;
};

struct Light {
  double sun_azimuth_deg = 180;  // from north towards east
  double sun_elevation_deg = 45;
  bool sun_is_stated = false;      // else a camera file may know better
  std::optional<double> exposure;  // factor on the sun's light; else from the background
  std::optional<std::array<double, 3>>
      sky_colour;  // linear RGB of the light from above; else from the background
  std::optional<std::array<double, 3>> ground_colour;
  // Share of the light of sun and sky that a level ground gives back, 0..1; else the ground in the
  // background, and where none is seen that of fields and roads (sequence/sequence/ambient.h).
  std::optional<double> ground_albedo;
  Where where;
};

// What light meets on its way to the sample, and when; the tables [shutter], [air], [optics] and
// [sensor]. Empty: not stated. Used by scenes and by camera.toml, which `airtruth calibrate`
// writes.
struct CameraModel {
  // [shutter]
  std::optional<double> exposure_s;
  std::optional<double> angle_deg;  // of 360 for a whole frame interval; in place of exposure_s
  std::optional<double> readout_s;
  std::optional<std::string> readout;  // down | up | right | left
  // [air]
  std::optional<std::array<double, 3>> extinction_per_km;  // red, green, blue
  std::optional<std::array<double, 3>> airlight;           // linear; else the background's
  // [optics]
  std::optional<double> point_spread_px;  // standard deviation of a Gaussian
  std::optional<double> sharpening;       // amount of an unsharp mask
  std::optional<double> sharpening_px;    // standard deviation of its Gaussian
  // [sensor]
  std::optional<double> noise_gain;   // variance of linear light is noise_gain * light
  std::optional<double> noise_floor;  // + noise_floor
  std::optional<double> noise_correlation_px;
  std::optional<double> chroma_spread_px;  // standard deviation, beyond luma's
  std::optional<double> codec_step;        // of the quantiser, in luma code values
  std::optional<double> gamma;             // exponent of the tone curve; else sRGB's curve
  // Keys that said "auto", as "air.airlight".
  std::vector<std::string> automatic;
};

struct Realism {
  std::optional<fs::path> file;        // a camera.toml: values for what the scene does not state
  bool automatic = false;              // what neither states is measured from the clip
  std::optional<std::string> profile;  // of a known camera: for what the clip cannot tell
  bool fallback = false;               // what cannot be measured is left out, with a warning
  Where where;
};

struct Intruder {
  std::string id;
  std::string aircraft;
  std::optional<std::string>
      model_forward;                    // for a bare model file: which of its axes is the nose ...
  std::optional<std::string> model_up;  // ... and which is up
  std::optional<double> catalogue_scale;  // of a catalogue's model; empty: to its published size
  std::optional<double> model_scale;      // metres per unit
  std::vector<Vector3> waypoints_ned_m;
  std::optional<double> speed_mps;
  std::vector<double> times_s;
  std::optional<fs::path> path_file;
  double start_s = 0;                                  // when the path begins, on the clip's clock
  std::optional<double> yaw_deg, pitch_deg, roll_deg;  // in place of the path's own
  Where where;
};

struct Render {
  int quality = 3;  // 1 (draft) .. 5 (oracle); 3 holds alpha within 1/64
};

struct Composite {
  std::string method = "matte";  // matte | chroma-key
};

struct Output {
  std::string video = "mp4";  // mp4 | mkv | avi | png
  int quality = 18;
  bool masks = false;  // also each intruder's alpha, frame by frame
};

struct Scene {
  std::string name;
  std::uint64_t seed = 1;
  Background background;
  Lens lens;
  Camera camera;
  Motion motion;
  Light light;
  CameraModel camera_model;
  Realism realism;
  std::vector<Intruder> intruders;
  Render render;
  Composite composite;
  Output output;
  fs::path file;
};

// Throws Error with line and column: not TOML, not UTF-8, larger than 16 MiB, an unknown key
// (nearest valid spelling), a wrong type, a value out of range, keys that exclude each other, a
// missing required key.
Scene read_scene(const fs::path& file);
Scene parse_scene(std::string_view text, const fs::path& file);

// camera.toml (docs/formats/camera.md): the tables of CameraModel, with what they were measured on.
struct CameraFile {
  CameraModel model;
  int width = 0;
  int height = 0;
  std::string
      lens;  // "" where none was given; else name and focal length, as lens_words() has them
  std::optional<double> gamma;  // of the tone curve that was measured under
  std::optional<double> sun_azimuth_deg;
  std::optional<double> sun_elevation_deg;
};
std::string toml_from_camera_model(const CameraModel& model);
CameraFile read_camera_file(const fs::path& file);
CameraFile parse_camera_file(std::string_view text, const fs::path& file);

// The effective scene as TOML, every key written out, paths absolute; parse_scene of it gives the
// same value.
std::string toml_from_scene(const Scene& scene);

}  // namespace airtruth::scene
