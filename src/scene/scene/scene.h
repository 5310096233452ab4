// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "camera/lens/lens.h"
#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/base/names.h"
#include "foundation/geometry/transform.h"
#include "foundation/geometry/within_frame.h"
#include "foundation/image/video_format.h"
#include "scene/scene/distractor.h"

// A scene file as a value: what the user wrote, with types and ranges checked, and before any other
// file is loaded. Each struct is a table of the file and each field is a key of the same name;
// docs/formats/scene.md describes them. Paths are already resolved against the scene file's folder.
// `where` is the table's place in the file, for errors that only appear later (an unknown aircraft,
// a path whose times do not increase).
//
// Example: a scene of one intruder that crosses from left to right, 800 m ahead
//
//   [background]
//   video = "clip.mp4"
//   [lens]
//   vertical_fov_deg = 75
//   [[intruder]]
//   aircraft = "738/738-Ryanair"
//   waypoints_ned_m = [[800, -40, -150], [800, 40, -150]]
//   speed_mps = 40
//
// On a clip of 1280 x 960 pixels without shake the lens has a focal length of 480 / tan(37.5 deg) =
// 625.5 px. The camera has its default pose: 150 m above the origin, looking north. The intruder
// starts at the pixel (640 - 625.5 * 40 / 800, 480) = (608.7, 480), reaches the image's centre
// after 1 s and ends after 2 s.
namespace airtruth::scene {

// The choices that a scene file states as a word: each is an enum with the words of the file. The
// words stand in no other place. lens::ModelKind and Readout are choices of [lens] and [shutter],
// image::VideoFormat and image::VideoEncoder of [output].

// [motion] model: how the camera's shake is modelled. kAuto means kRotation, and kHomography for
// the compositing method kChromaKey.
enum class MotionModel { kAuto, kRotation, kHomography, kNone };

constexpr auto enum_names(MotionModel) {
  return std::to_array<EnumName<MotionModel>>({{MotionModel::kAuto, "auto"},
                                               {MotionModel::kRotation, "rotation"},
                                               {MotionModel::kHomography, "homography"},
                                               {MotionModel::kNone, "none"}});
}

// [motion] reference: the pose against which shake is measured.
enum class MotionReference { kFirstFrame, kSmoothed };

constexpr auto enum_names(MotionReference) {
  return std::to_array<EnumName<MotionReference>>(
      {{MotionReference::kFirstFrame, "first_frame"}, {MotionReference::kSmoothed, "smoothed"}});
}

// [composite] method: how a rendered aircraft is put into the frame.
enum class CompositeMethod { kMatte, kChromaKey };

constexpr auto enum_names(CompositeMethod) {
  return std::to_array<EnumName<CompositeMethod>>(
      {{CompositeMethod::kMatte, "matte"}, {CompositeMethod::kChromaKey, "chroma-key"}});
}

// [background]: the onboard video and the range of its frames that is rendered.
struct Background {
  fs::path video;
  // What reports and breakdowns call it; empty: the name of its file.
  std::string name;
  std::optional<fs::path> mask;
  std::int64_t first_frame = 0;
  std::optional<std::int64_t> frame_count;
  // Of numbered pictures, which state none.
  std::optional<double> frame_rate_hz;
  Where where;
};

// [lens]: a model with its parameters, or a calibration file.
struct Lens {
  lens::ModelKind model = lens::ModelKind::kPinhole;
  std::optional<double> vertical_fov_deg;
  std::optional<Pixel> focal_px;
  std::optional<Pixel> principal_point_px;
  std::vector<double> distortion;
  std::optional<fs::path> file;
  Where where;
};

// [camera]: the nominal, unshaken pose of the camera, as uniform motion, as a path file or from a
// flight log.
struct Camera {
  Vector3 position_ned_m{0, 0, -150};
  Vector3 velocity_ned_mps{0, 0, 0};
  // At the first frame. Empty: that of the log, else of the horizon
  // (sequence/setup/level_camera.h).
  std::optional<YawPitchRoll> attitude_yaw_pitch_roll_deg;
  std::optional<fs::path> path_file;
  // A log of the flight (scene/flight_log/flight_log.h).
  std::optional<fs::path> log;
  // Time of the log = time of the clip + log_offset_s. Empty: the log is on the video's clock.
  std::optional<double> log_offset_s;
  // Time of the clip's first frame on the video's clock. It follows from [background] first_frame
  // and the video (sequence/setup/from_scene.h).
  double clip_start_s = 0;
  // Whether the scene states the position at the first frame; else it is that of a log.
  bool position_is_stated = false;
  // True where the attitude is that of the path file or the log throughout: the measured motion is
  // the shake about its mean (`smoothed`, setup/steady_camera.h), or none is measured. Otherwise it
  // is that of the first frame, from where the measured motion turns it.
  bool follows_attitude = false;
  Where where;
};

// [motion]: how the camera's shake is measured.
struct Motion {
  MotionModel model = MotionModel::kAuto;
  MotionReference reference = MotionReference::kFirstFrame;
  double smoothing_s = 1.0;
  Where where;
};

// [light]: the sun and the light from sky and ground.
struct Light {
  // Measured from north towards east.
  double sun_azimuth_deg = 180;
  double sun_elevation_deg = 45;
  // True where the scene states the sun's direction. Otherwise a camera file's direction takes
  // precedence.
  bool sun_is_stated = false;
  // Factor on the sun's light; empty: estimated from the background.
  std::optional<double> exposure;
  // Linear RGB of the light from above and from below; empty: estimated from the background.
  std::optional<std::array<double, 3>> sky_colour;
  std::optional<std::array<double, 3>> ground_colour;
  // Share of the light of sun and sky that level ground reflects, 0..1. Empty: that of the ground
  // in the background, and where no ground is seen that of fields and roads
  // (sequence/insertion/ambient.h).
  std::optional<double> ground_albedo;
};

// The camera between the light of the scene and the stored sample; the tables [shutter], [air],
// [optics] and [sensor]. An empty field is not stated. Scenes use this struct, and so does
// camera.toml, which `airtruth calibrate` writes. Every field has a row in camera_keys.h.
struct CameraModel {
  // [shutter]
  std::optional<double> exposure_s;
  // Shutter angle; 360 degrees expose for a whole frame interval. Excludes exposure_s.
  std::optional<double> angle_deg;
  std::optional<double> readout_s;
  // Direction in which the rows are read; empty: down.
  std::optional<Readout> readout;
  // [air]
  // For red, green and blue.
  std::optional<std::array<double, 3>> extinction_per_km;
  // Linear RGB; empty: estimated from the background.
  std::optional<std::array<double, 3>> airlight;
  // [optics]
  // Standard deviation of a Gaussian.
  std::optional<double> point_spread_px;
  // Standard deviation by which the picture is softer along its columns than along its rows.
  std::optional<double> vertical_spread_px;
  // Amount of an unsharp mask.
  std::optional<double> sharpening;
  // Standard deviation of the unsharp mask's Gaussian.
  std::optional<double> sharpening_px;
  // [sensor]
  // The noise's variance at linear light x is noise_gain * x + noise_floor.
  std::optional<double> noise_gain;
  std::optional<double> noise_floor;
  std::optional<double> noise_correlation_px;
  // Standard deviation of the blur of chroma beyond that of luma.
  std::optional<double> chroma_spread_px;
  // Step of the codec's quantiser, in luma code values.
  std::optional<double> codec_step;
  // Exponent of the tone curve; empty: sRGB's curve.
  std::optional<double> gamma;
  // Keys whose value is "auto", for example "air.airlight".
  std::vector<std::string> automatic;
};

// [weather]: how the light and the camera of what is inserted depart from those of the clip, whose
// own picture stays as it is. An empty factor is 1. Every field has a row in kWeatherKeys
// (camera_keys.h).
struct Weather {
  // On the light of sun, sky and ground that falls on what is inserted.
  std::optional<double> exposure;
  // On the ratio of red to blue in that light.
  std::optional<double> white_balance;
  // On optics.point_spread_px and optics.vertical_spread_px.
  std::optional<double> blur;
  // On the standard deviation of the sensor's noise.
  std::optional<double> noise;
  // Share of the sun's direct light that reaches what is inserted: 0 behind a cloud.
  std::optional<double> sun_share;
  Where where;
};

// [realism]: where the camera model's values come from when the scene does not state them.
struct Realism {
  // A camera.toml, whose values fill in for keys that the scene does not state.
  std::optional<fs::path> file;
  // True: keys that neither the scene nor the file states are measured from the clip.
  bool automatic = false;
  // Name of a known camera, whose values fill in for keys that the clip cannot give.
  std::optional<std::string> profile;
  // True: a quantity that cannot be measured is left out with a warning.
  bool fallback = false;
  Where where;
};

// [intruder.encounter]: a path by its closest approach to the own aircraft
// (encounter/placement/by_approach.h states how it follows).
struct Encounter {
  // When the two come nearest, in seconds of the clip.
  double cpa_time_s = 0;
  // Where the intruder is then, from the own aircraft: right of and ahead along the own course, and
  // above. One of right and ahead may be empty: it follows.
  std::optional<double> cpa_right_m, cpa_ahead_m;
  double cpa_above_m = 0;
  // Course over the ground from the own course, clockwise: 180 is head-on.
  double course_deg = 180;
  double speed_mps = 0;  // along the path, climb included
  double climb_mps = 0;
  double turn_rate_dps = 0;  // positive to the right
  Where where;
};

// [[intruder.seen]]: a place of the path by what the picture shows. Exactly one of range_m and
// width_px is present.
struct Seen {
  // Of the frame nearest to it, in seconds of the clip.
  double time_s = 0;
  Pixel pixel = Pixel::Zero();
  std::optional<double> range_m;
  std::optional<double> width_px;  // of the exact box
  Where where;
};

// [[intruder]]: an aircraft and its path; or [[distractor]] in the air. A path comes from waypoints
// with a speed or with times, from a file, from an encounter, or from what is seen.
struct Intruder {
  std::string id;
  // Of a distractor: the name of its kind.
  std::string aircraft;
  // Empty for an aircraft.
  std::optional<Distractor> distractor;
  // For a bare model file: the axes of the model that point to the nose and upwards.
  std::optional<std::string> model_forward;
  std::optional<std::string> model_up;
  // Scale of a catalogue's model; empty: the model is scaled to the aircraft's published size.
  std::optional<double> catalogue_scale;
  // Scale of a model file, in metres per unit.
  std::optional<double> model_scale;
  // How long its propellers and rotors have turned when the clip begins.
  double spin_time_s = 0;
  std::vector<Vector3> waypoints_ned_m;
  std::optional<double> speed_mps;
  std::vector<double> times_s;
  std::optional<fs::path> path_file;
  std::optional<Encounter> encounter;
  // At increasing times; empty, or at least two.
  std::vector<Seen> seen;
  // The time at which the path begins, in seconds of the clip.
  double start_s = 0;
  // Each angle replaces that of the path.
  std::optional<double> yaw_deg, pitch_deg, roll_deg;
  // Of a distractor, in place of a path: where it is at the time 0, and its steady velocity.
  std::optional<Vector3> position_ned_m;
  Vector3 velocity_ned_mps = Vector3::Zero();
  // Of a distractor: its place beside the path, which a flock shares.
  Vector3 offset_ned_m = Vector3::Zero();
  Where where;
};

inline bool is_aircraft(const Intruder& intruder) { return !intruder.distractor; }

// [[truth.volume]]: a volume of airspace by own thresholds (encounter/separation/violation.h).
struct TruthVolume {
  std::string name;
  double horizontal_m = 0;
  double vertical_m = 0;
  double tau_s = 0;
  double coaltitude_s = 0;
};

// [[occluder]]: what stands in the picture before the intruders that are farther from the camera.
// Exactly one of mask and beyond_horizon is present.
struct Occluder {
  double range_m = 0;
  // A grey picture, or numbered ones, a picture for each frame of the clip: white hides.
  std::optional<fs::path> mask;
  // What is below the horizon.
  bool beyond_horizon = false;
  Where where;
};

// [truth]: what the truth says of an encounter beside its measures.
struct Truth {
  // Names of known volumes.
  std::vector<std::string> volumes;
  std::vector<TruthVolume> own_volumes;
  // How far ahead miss distances and violations look.
  double lookahead_s = 180;
  Where where;
};

// [render]: the quality of the rendering.
struct Render {
  // From 1 (draft) to 5 (the reference of the tests); 3 holds alpha within 1/64.
  int quality = 3;
};

// [composite]: how the rendered aircraft is put into the frame.
struct Composite {
  CompositeMethod method = CompositeMethod::kMatte;
};

// [output]: the files that are written.
struct Output {
  // A folder of pictures for kPng.
  image::VideoFormat video = image::VideoFormat::kMp4;
  int quality = 18;
  // For kMp4: the longest time between two key frames, from which alone a reader can begin.
  double keyframe_s = 0.5;
  // For kMp4.
  image::VideoEncoder encoder = image::VideoEncoder::kX264;
  Where encoder_where;
  // True: each intruder's alpha is written as well, frame by frame.
  bool masks = false;
};

// The tables of a scene file that say what films it, which a background of a catalogue has as well.
struct CameraTables {
  Lens lens;
  Camera camera;
  Motion motion;
  Light light;
  CameraModel camera_model;
  Realism realism;
  std::vector<Occluder> occluders;
};

// Those that say what is made of it, which a catalogue has as well.
struct OutputTables {
  Truth truth;
  Render render;
  Composite composite;
  Output output;
};

// A whole scene file.
struct Scene : CameraTables, OutputTables {
  std::string name;
  std::uint64_t seed = 1;
  // How many encounters of real traffic the scene stands for, up to a factor that a data set
  // shares; empty where it is not drawn from a model of traffic.
  std::optional<double> weight;
  Background background;
  Weather weather;
  // The aircraft first, in the order of the file, then the distractors in the air.
  std::vector<Intruder> intruders;
  // The distractors on the lens.
  std::vector<LensMark> lens_marks;
  fs::path file;
};

// Reads a scene. Throws Error with line and column where the text is not TOML, not UTF-8 or larger
// than 16 MiB, and for an unknown key (the message offers the nearest spelling), a wrong type, a
// value out of range, keys that exclude each other and a missing required key.
Scene read_scene(const fs::path& file);
Scene parse_scene(std::string_view text, const fs::path& file);

// camera.toml (docs/formats/camera.md): the tables of CameraModel and what they were measured on.
struct CameraFile {
  CameraModel model;
  int width = 0;
  int height = 0;
  // Name and focal length in the form of lens_words(); "" where no lens was given.
  std::string lens;
  // Exponent of the tone curve that the measurement assumed.
  std::optional<double> gamma;
  std::optional<double> sun_azimuth_deg;
  std::optional<double> sun_elevation_deg;
};
std::string toml_from_camera_model(const CameraModel& model);
CameraFile read_camera_file(const fs::path& file);
CameraFile parse_camera_file(std::string_view text, const fs::path& file);

// The files and folders that a scene names, its video first, with the tables that name them: what a
// run of it reads and must not replace. Models of aircraft are not among them.
struct StatedFile {
  fs::path path;
  Where where;
};
std::vector<StatedFile> stated_files(const Scene& scene);

// The effective scene as TOML: every key is written out and every path is absolute. parse_scene()
// of the text gives the same value.
std::string toml_from_scene(const Scene& scene);

}  // namespace airtruth::scene
