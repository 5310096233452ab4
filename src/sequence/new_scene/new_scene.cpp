// SPDX-License-Identifier: Apache-2.0
#include "sequence/new_scene/new_scene.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "camera/focal_length/lens_estimate.h"
#include "camera/horizon/horizon.h"
#include "camera/lens/calibration_file.h"
#include "camera/lens/calibration_write.h"
#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "picture/video/reader.h"
#include "picture/video/tags.h"
#include "picture/video/telemetry.h"
#include "sequence/new_scene/first_encounter.h"
#include "sequence/new_scene/lens_hint.h"
#include "sequence/setup/own_log.h"

namespace airtruth::sequence {
namespace {

namespace fs = std::filesystem;

constexpr double kGuessedViewDeg = 60;
constexpr std::int64_t kMaxEstimateFrames =
    900;  // half a minute at 30 frames/s turns enough or never
constexpr std::size_t kMaxSubtitleBytes = std::size_t{64} << 20;

// What is known of the lens: the words for the scene, and the lens itself.
struct LensWords {
  lens::Lens lens;
  std::string table;  // of the scene
  std::string origin;
};

// The subtitles that DJI's aircraft write beside a video; empty where there are none.
std::optional<fs::path> subtitles_of(const fs::path& video) {
  for (const char* ending : {".SRT", ".srt"}) {
    fs::path file = video;
    file.replace_extension(ending);
    if (fs::is_regular_file(file)) return file;
  }
  return std::nullopt;
}

LensWords in_words(const lens::Lens& lens, const std::string& origin) {
  return {lens, lens::scene_table(lens), origin};
}

std::optional<LensWords> lens_from_files(const fs::path& video, lens::ImageSize size) {
  for (const video::TelemetryPacket& packet : video::read_telemetry(video))
    if (const auto view = diagonal_view_deg(packet.bytes))
      return in_words(fisheye_from_diagonal(*view, size),
                      fmt::format("the GoPro's telemetry states a diagonal view of {:.1f} degrees; "
                                  "its distortion is not known",
                                  *view));
  std::optional<double> mm;
  std::string origin = "the video's tags";
  if (const auto subtitles = subtitles_of(video)) {
    mm = equivalent_mm_in_subtitles(read_file(*subtitles, kMaxSubtitleBytes));
    if (mm) origin = subtitles->filename().string();
  }
  if (!mm) mm = equivalent_mm_in_tags(video::read_tags(video));
  if (!mm) return std::nullopt;
  return in_words(
      pinhole_from_equivalent(*mm, size),
      fmt::format("{} states {:.0f} mm for 35 mm film; a video mode that crops the sensor "
                  "has a longer focal length",
                  origin,
                  *mm));
}

std::optional<LensWords> estimated_lens(const fs::path& video, const NewSceneOptions& options) {
  video::ReaderOptions reader_options;
  reader_options.frame_count = kMaxEstimateFrames;
  reader_options.with_cuts = true;
  video::Reader reader(video, reader_options, options.warn);
  const lens::ImageSize size{reader.info().width, reader.info().height};
  motion::LensEstimator estimator(size.width, size.height);
  const std::int64_t total = std::min(kMaxEstimateFrames, reader.info().frame_count_estimate);
  while (const auto frame = reader.next()) {
    if (options.stop.stop_requested()) throw Interrupted();
    estimator.add(frame->picture, frame->begins_shot);
    if (options.progress) options.progress(frame->index + 1, total);
  }
  std::string why;
  const auto found = estimator.result(why);
  if (!found || !found->is_certain) return std::nullopt;
  const Pixel focal(found->focal_px, found->focal_px), middle(size.width / 2.0, size.height / 2.0);
  const lens::Lens lens = found->fisheye
                              ? lens::Lens(lens::Fisheye{focal, middle, {0, 0, 0, 0}}, size)
                              : lens::Lens(lens::Pinhole{focal, middle}, size);
  return in_words(
      lens,
      fmt::format(
          "estimated from the video: {:.0f} +- {:.0f} px", found->focal_px, found->sigma_px));
}

LensWords lens_for(const fs::path& video, lens::ImageSize size, const NewSceneOptions& options) {
  if (options.lens)
    return {lens::read_calibration(*options.lens, size),
            fmt::format("[lens]\nfile = \"{}\"\n", fs::absolute(*options.lens).string()),
            "the stated calibration"};
  if (auto found = lens_from_files(video, size)) return *found;
  if (auto found = estimated_lens(video, options)) return *found;
  return {lens::pinhole_from_vertical_fov(kGuessedViewDeg, size),
          fmt::format("[lens]\nmodel = \"pinhole\"\nvertical_fov_deg = {}\n", kGuessedViewDeg),
          "A GUESS: no file states the lens, and the video turns too little to show it; put the "
          "camera's vertical view here, or a calibration as file = \"camera.yml\""};
}

// Pitch and roll of the camera in a picture with a horizon.
std::optional<YawPitchRoll> attitude_in(const image::Picture& picture, const lens::Lens& lens) {
  const auto found = motion::HorizonFinder(lens, nullptr).find(picture);
  if (!found || !found->is_sharp()) return std::nullopt;
  return motion::attitude_from_up(found->up_in_cam);
}

// The log beside the video or within it; empty where there is none with positions.
std::optional<fs::path> log_of(const fs::path& video) {
  const auto subtitles = subtitles_of(video);
  for (const fs::path& file : {subtitles.value_or(video), video}) {
    try {
      read_log(file);
      return file;
    } catch (const Error&) {  // no log: the scene states a path of its own
    }
  }
  return std::nullopt;
}

std::string quoted(const fs::path& path) {
  std::string text = "\"";
  for (const char c : path.string()) {
    if (c == '"' || c == '\\') text += '\\';
    text += c;
  }
  return text + '"';
}

struct CameraWords {
  scene::Camera camera;
  std::string table;
};

CameraWords camera_for(const fs::path& video, const std::optional<YawPitchRoll>& attitude) {
  CameraWords words;
  words.table = "[camera]\n";
  const auto log = log_of(video);
  if (log) {
    words.camera.log = log;
    words.table +=
        fmt::format("log = {}                  # where the aircraft flew: airtruth log show\n",
                    quoted(fs::absolute(*log)));
  } else {
    words.camera.position_ned_m = {0, 0, -150};
    words.camera.velocity_ned_mps = {20, 0, 0};
    words.table +=
        "position_ned_m = [0, 0, -150]          # north, east, down of the first frame: 150 m high "
        "(a guess)\n"
        "velocity_ned_mps = [20, 0, 0]          # the own speed (a guess); a flight log is better: "
        "log = \"flight.srt\"\n";
  }
  if (attitude) {
    words.camera.attitude_yaw_pitch_roll_deg = {0, attitude->pitch_deg, attitude->roll_deg};
    words.camera.attitude_is_stated = log.has_value();
    words.table += fmt::format(
        "attitude_yaw_pitch_roll_deg = [0, {:.1f}, {:.1f}]   # pitch and roll are those of the "
        "horizon in the first frame\n",
        attitude->pitch_deg,
        attitude->roll_deg);
  } else if (!log) {
    words.table +=
        "attitude_yaw_pitch_roll_deg = [0, 0, 0]  # no horizon was found in the first frame\n";
  }
  return words;
}

}  // namespace

std::string new_scene(const fs::path& video, const NewSceneOptions& options) {
  video::Reader reader(video, {}, options.warn);
  const video::StreamInfo info = reader.info();
  const lens::ImageSize size{info.width, info.height};
  const auto first = reader.next();
  const LensWords lens = lens_for(video, size, options);
  const CameraWords camera =
      camera_for(video, first ? attitude_in(first->picture, lens.lens) : std::nullopt);
  const double rate_hz = info.frame_rate.value();
  const double duration_s =
      rate_hz > 0
          ? static_cast<double>(std::max<std::int64_t>(1, info.frame_count_estimate) - 1) / rate_hz
          : 0;
  return fmt::format(
      "# {}: {} frames of {}x{} at {:.4g} frames/s, {:.1f} s.\n"
      "#     airtruth preview THIS.toml        shows where the intruder will be, in two seconds\n"
      "#     airtruth render THIS.toml --out out\n"
      "# Every key: docs/formats/scene.md and examples/render.toml.\n\n"
      "[background]\nvideo = {}\n\n"
      "# {}.\n{}\n"
      "{}\n"
      "[light]                                  # the sun, from north towards east and above the "
      "horizon\n"
      "sun_azimuth_deg = 180\nsun_elevation_deg = 45\n\n"
      "{}",
      video.filename().string(),
      info.frame_count_estimate,
      info.width,
      info.height,
      rate_hz,
      duration_s,
      quoted(fs::absolute(video)),
      lens.origin,
      lens.table,
      camera.table,
      first_encounter(lens.lens, camera.camera, duration_s));
}

}  // namespace airtruth::sequence
