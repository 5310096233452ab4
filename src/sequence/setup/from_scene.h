// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "camera/lens/lens.h"
#include "encounter/separation/violation.h"
#include "foundation/base/error.h"
#include "foundation/geometry/transform.h"
#include "foundation/geometry/within_frame.h"
#include "foundation/image/tone_curve.h"
#include "picture/composite/sensor.h"
#include "picture/video/writer.h"
#include "scene/flight_log/flight_log.h"
#include "scene/scene/scene.h"
#include "scene/trajectory/path.h"

// What the tables of a scene file mean to the modules that work with them: one function for each
// table. A scene holds choices and optional numbers as its file states them; lens, composite and
// trajectory take values of their own.
namespace airtruth::setup {

// [lens]: read from its file, or built from the view or the focal lengths for a picture of `size`.
// Error where a calibration cannot be read or is of another size.
lens::Lens lens_of(const scene::Lens& lens, lens::ImageSize size, const Warn& warn = {});

// Of pixels that are not square the focal lengths in their widths and heights differ: states both
// in place of a view. `width_of_height` is the pixels' shape; 0: unknown.
void take_pixel_shape(scene::Lens& lens, lens::ImageSize size, double width_of_height);

// States the time of a clip's first frame on the clock of its video, by which a log of the video
// counts; of a log with a stated offset, and of a camera without a log, nothing.
void state_clip_start(scene::Camera& camera,
                      const std::filesystem::path& video,
                      std::int64_t first_frame,
                      const std::optional<double>& picture_rate_hz);

// [camera]: where the own aircraft is at each time of the clip. Errors as of read_path_file().
//
// The attitude of a path file or a log is that at the first frame, and is held, since the measured
// motion turns the camera from there. Where follows_attitude is true it is the file's throughout.
//
// Of a log the position at the first frame is the stated one; without it the aircraft is over the
// origin at the log's height above take-off, or at the default height of a scene where the log
// states none. The attitude at the first frame is the stated one; without it it is the log's, and
// for a log without attitudes the aircraft is level and heads along its path, or keeps its heading
// where it hovers (trajectory::Heading). Where follows_attitude is true the stated one turns from
// there as the log's does.
//
// Throws Error where the log cannot be read, has a clock of its own and no log_offset_s, or does
// not cover the first frame, with its attitudes too where they turn the camera.
trajectory::Path camera_path(const scene::Camera& camera, const Warn& warn = {});
// Warns of a log without attitudes whose aircraft is too slow at the first frame for its path to
// tell the heading (trajectory::kMeasuredCourseMps), where that heading is used.
void warn_of_hover(const scene::Camera& camera, const Warn& warn);
// The same path where no motion is measured yet: the file's attitude is all that turns the camera.
trajectory::Path unmeasured_camera_path(scene::Camera camera);

// Warns of gaps of more than 3 s in the log's positions, and in those of its attitudes that turn
// the camera, over which a clip of that length lies.
void warn_of_gaps(const scene::Camera& camera, double clip_s, const Warn& warn);

// [[intruder]]: its path on the clip's clock, beside the own aircraft's nominal path. What is
// `seen` must have been placed (seen.h).
trajectory::Path path_of(const scene::Intruder& intruder, const trajectory::Path& own);

// [truth]: the volumes that it asks for, with those of own thresholds last. Error where a name is
// unknown.
std::vector<separation::AskedVolume> volumes_of(const scene::Truth& truth);

// [light]: the unit vector to the sun, in world axes.
Vector3 to_sun_in_world(const scene::Light& light);

// [shutter] of a camera model without "auto" keys (pipeline/resolved_scene.h). Defaults: exposure
// and read-out of 0 s.
Shutter shutter_of(const scene::CameraModel& model);

// [sensor] gamma: the curve from linear light to code values; sRGB's where gamma is not stated.
image::ToneCurve tone_of(const scene::CameraModel& model);

// The camera model of what is inserted: that of the clip, changed by [weather].
scene::CameraModel camera_in_weather(const scene::Scene& scene);

// [optics] and [sensor]: what the camera does to samples after the point spread. Quantities that
// the model lacks are 0: no sharpening, no noise, no chroma spread.
composite::Sensor sensor_of(const scene::CameraModel& model);

// [sensor] codec_step: true where the codec's mark is made.
bool has_codec(const scene::CameraModel& model);

// Adds the place in the scene to an Error that names no file.
template <typename Make>
decltype(auto) at_place(const Where& where, Make make) {
  try {
    return make();
  } catch (const Error& error) {
    if (!error.where().file.empty()) throw;
    throw Error(error.message(), where);
  }
}

// Reads a flight log of any format, also out of a GoPro's video. Errors as of read_flight_log().
flight_log::FlightLog read_log(const std::filesystem::path& path);

}  // namespace airtruth::setup
