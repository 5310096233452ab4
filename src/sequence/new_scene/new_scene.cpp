// SPDX-License-Identifier: Apache-2.0
#include "sequence/new_scene/new_scene.h"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "calibration/camera_file/profile.h"
#include "camera/focal_length/lens_estimator.h"
#include "camera/gyro/gpmf.h"
#include "camera/horizon/horizon.h"
#include "camera/lens/calibration_file.h"
#include "camera/motion/estimator.h"
#include "camera/motion/shake.h"
#include "encounter/placement/by_approach.h"
#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/base/text.h"
#include "picture/video/metadata.h"
#include "picture/video/numbered_frames.h"
#include "picture/video/reader.h"
#include "sequence/setup/from_scene.h"
#include "sequence/setup/level_camera.h"
#include "sequence/setup/moment.h"
#include "sequence/setup/motion_source.h"

namespace airtruth::new_scene {
namespace {

constexpr double kFilmDiagonalMm = 43.27;  // of 36 x 24 mm
// Focal lengths of cameras on aircraft and phones for 35 mm film; others are a fault of the file.
constexpr double kMinEquivalentMm = 5, kMaxEquivalentMm = 2000;
// Diagonal fields of view of such cameras; others are a fault of the file too.
constexpr double kMinViewDeg = 5, kMaxViewDeg = 200;

std::optional<double> number_in(std::string_view text) {
  text.remove_prefix(std::min(text.find_first_not_of(" :"), text.size()));
  double value = 0;
  const auto [rest, failed] = std::from_chars(text.data(), text.data() + text.size(), value);
  return failed == std::errc() ? std::optional(value) : std::nullopt;
}

std::optional<double> plausible(std::optional<double> mm) {
  return mm && *mm >= kMinEquivalentMm && *mm <= kMaxEquivalentMm ? mm : std::nullopt;
}

// The focal length of the tags of a phone's or a camera's video, in millimetres for a picture of 35
// mm film; empty where no tag states it.
std::optional<double> equivalent_mm_in_tags(const std::map<std::string, std::string>& tags) {
  for (const auto& [key, value] : tags)
    if (key.find("focal") != std::string::npos && key.find("35mm") != std::string::npos)
      if (const auto mm = plausible(number_in(value))) return mm;
  return std::nullopt;
}

// In heights of pixels.
double half_diagonal_px(lens::ImageSize size, double width_of_height) {
  return 0.5 * std::hypot(size.width * width_of_height, size.height);
}

}  // namespace

std::optional<double> equivalent_mm_in_subtitles(std::string_view text) {
  constexpr std::string_view kKey = "focal_len";
  const std::size_t at = text.find(kKey);
  if (at == std::string_view::npos) return std::nullopt;
  const auto value = number_in(text.substr(at + kKey.size()));
  if (!value) return std::nullopt;
  return plausible(*value > 100 ? *value / 10 : *value);
}

std::optional<double> diagonal_view_deg(std::span<const std::uint8_t> packet) {
  std::optional<double> view;
  gyro::each_gpmf_stream(packet, [&](std::span<const std::uint8_t> stream) {
    gyro::each_gpmf_element(stream, [&](const gyro::GpmfElement& e) {
      if (e.key != "ZFOV" || e.type != 'f' || e.size != 4 || e.count == 0) return;
      const float degrees = std::bit_cast<float>(gyro::big_endian(e.data, 0, 4));
      if (degrees >= kMinViewDeg && degrees <= kMaxViewDeg) view = degrees;
    });
  });
  return view;
}

lens::Lens pinhole_from_equivalent(double equivalent_mm,
                                   lens::ImageSize size,
                                   double width_of_height) {
  const double focal_px =
      equivalent_mm / kFilmDiagonalMm * 2 * half_diagonal_px(size, width_of_height);
  return lens::undistorted(false, focal_px, size, width_of_height);
}

lens::Lens fisheye_from_diagonal(double view_deg, lens::ImageSize size, double width_of_height) {
  const double focal_px = half_diagonal_px(size, width_of_height) / radians(view_deg / 2);
  return lens::undistorted(true, focal_px, size, width_of_height);
}

Stretch steady_stretch(const std::vector<motion::FrameMotion>& motion,
                       double turn_rad,
                       std::size_t most) {
  const auto rotation = [&](std::size_t k) {
    return motion[k].rotation.value_or(Quaternion::Identity());
  };
  Stretch longest;
  for (std::size_t first = 0; first < motion.size() && longest.frames < most; ++first) {
    const Quaternion at_first = rotation(first);
    std::size_t end = first + 1;
    while (end < motion.size() && end - first < most && motion[end].state != motion::State::kCut &&
           at_first.angularDistance(rotation(end)) <= turn_rad)
      ++end;
    if (end - first > longest.frames) longest = {first, end - first};
  }
  return longest;
}

namespace {

constexpr double kGuessedViewDeg = 60;  // vertical view of a lens that nothing states: chosen
constexpr std::int64_t kMaxEstimateFrames =
    900;  // half a minute at 30 frames/s turns enough or never
constexpr std::int64_t kMaxMotionFrames = 1800;  // a minute at 30 frames/s
// Height of a camera without a log: chosen.
constexpr double kGuessedHeightM = 150;
// How long a first encounter lasts.
constexpr double kEncounterS = 13.2;
// A camera that turns by less than this share of its view keeps what is in the middle in view.
constexpr double kSteadyShare = 0.2;
constexpr std::size_t kMaxTextBytes = std::size_t{64} << 20;  // chosen

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

// A path as a string of the scene. Throws Error where a scene cannot state it.
std::string in_quotes(const fs::path& path) {
  const std::string text = path.string();
  if (std::ranges::any_of(text, is_control))
    throw Error("has a control character in its name; expected a name that a scene can state",
                {text});
  return toml_string(text);
}

// A file as the scene names it: relative to the scene's folder where that is stated.
std::string as_written(const fs::path& file, const NewSceneOptions& options) {
  const fs::path whole = absolute_path(file);
  if (!options.folder) return in_quotes(whole);
  const fs::path folder = absolute_path(*options.folder);
  const fs::path relative = whole.lexically_proximate(folder);
  // A folder that is a link has another one above it.
  return in_quotes(absolute_path(folder / relative) == whole ? relative : whole);
}

LensWords in_words(const lens::Lens& lens, const std::string& origin) {
  return {lens, lens::scene_table(lens), origin};
}

std::optional<LensWords> lens_from_files(const fs::path& video,
                                         lens::ImageSize size,
                                         double width_of_height) {
  for (const video::TelemetryPacket& packet : video::read_telemetry(video))
    if (const auto view = diagonal_view_deg(packet.bytes))
      return in_words(fisheye_from_diagonal(*view, size, width_of_height),
                      fmt::format("the GoPro's telemetry states a diagonal view of {:.1f} degrees; "
                                  "its distortion is not known",
                                  *view));
  std::optional<double> mm;
  std::string origin = "the video's tags";
  if (const auto subtitles = subtitles_of(video)) {
    mm = equivalent_mm_in_subtitles(read_file(*subtitles, kMaxTextBytes));
    if (mm) origin = subtitles->filename().string();
  }
  if (!mm) mm = equivalent_mm_in_tags(video::read_tags(video));
  if (!mm) return std::nullopt;
  return in_words(
      pinhole_from_equivalent(*mm, size, width_of_height),
      fmt::format("{} states {:.0f} mm for 35 mm film; a video mode that crops the sensor "
                  "has a longer focal length",
                  origin,
                  *mm));
}

// A usual view, or an estimate that is not certain where that view is outside its interval.
LensWords guessed_lens(lens::ImageSize size,
                       double width_of_height,
                       const std::string& why,
                       const std::optional<focal_length::LensEstimator::Result>& within) {
  const std::string origin = fmt::format(
      "A GUESS: no file states the lens, and {}; put the camera's view here, or a calibration as "
      "file = \"camera.yml\"",
      why);
  const lens::Lens usual = within && within->fisheye
                               ? lens::fisheye_from_vertical_fov(kGuessedViewDeg, size)
                               : lens::pinhole_from_vertical_fov(kGuessedViewDeg, size);
  const double usual_px = usual.focal_px();
  if (!within)
    return {lens::undistorted(false, usual_px, size, width_of_height),
            fmt::format("[lens]\nmodel = \"pinhole\"\nvertical_fov_deg = {}\n", kGuessedViewDeg),
            origin};
  const bool is_possible = usual_px >= within->low_px && usual_px <= within->high_px;
  const double focal_px = is_possible ? usual_px : within->focal_px;
  return in_words(lens::undistorted(within->fisheye, focal_px, size, width_of_height), origin);
}

LensWords estimated_lens(const fs::path& video, const NewSceneOptions& options) {
  video::Reader reader(video,
                       {.frame_count = kMaxEstimateFrames,
                        .picture_rate_hz = options.picture_rate_hz,
                        .with_cuts = true},
                       options.warn);
  const lens::ImageSize size{reader.info().width, reader.info().height};
  const double width_of_height = reader.info().sample_aspect.value();
  focal_length::LensEstimator estimator(size.width, size.height, nullptr, width_of_height);
  const std::int64_t total = std::min(kMaxEstimateFrames, reader.info().frame_count_estimate);
  while (const auto frame = reader.next()) {
    if (options.stop.stop_requested()) throw Interrupted();
    estimator.add(frame->picture, frame->begins_shot);
    if (options.progress) options.progress(frame->index + 1, total);
  }
  std::string why;
  const auto found = estimator.result(why);
  if (!found || !found->is_certain) return guessed_lens(size, width_of_height, why, found);
  return in_words(lens::undistorted(found->fisheye, found->focal_px, size, width_of_height),
                  fmt::format("estimated from the video: a focal length of {:.0f} px, {} at 95 % "
                              "(airtruth lens estimate); a calibration is better",
                              found->focal_px,
                              focal_length::LensEstimator::interval_words(*found)));
}

// What airtruth lens estimate has written of its doubt into a calibration, as opencv_calibration()
// has it; empty for any other.
std::string note_in(const fs::path& calibration) {
  const std::string text = read_file(calibration, kMaxTextBytes);
  const std::size_t at = text.find(fmt::format("# {}", focal_length::kEstimatedNote));
  if (at == std::string::npos) return "";
  // A scene's comment can hold no carriage return.
  return fmt::format(", {}", trimmed(text.substr(at + 2, text.find('\n', at) - at - 2)));
}

LensWords lens_for(const fs::path& video,
                   const video::StreamInfo& info,
                   const NewSceneOptions& options) {
  const lens::ImageSize size{info.width, info.height};
  if (options.lens)
    return {lens::read_calibration(*options.lens, size, options.warn),
            fmt::format("[lens]\nfile = {}\n", as_written(*options.lens, options)),
            "the stated calibration" + note_in(*options.lens)};
  if (auto found = lens_from_files(video, size, info.sample_aspect.value())) return *found;
  return estimated_lens(video, options);
}

// The up direction of the horizon that is seen in a picture; empty for one that stands upside down.
std::optional<Vector3> seen_up_in(const image::Picture& picture, const lens::Lens& lens) {
  const auto found = horizon::HorizonFinder(lens, nullptr).find(picture);
  if (!found || !found->is_sharp() ||
      std::abs(horizon::attitude_from_up(found->up_in_cam).roll_deg) > setup::kMostRollDeg)
    return std::nullopt;
  return found->up_in_cam;
}

// The log beside the video or within it; empty where there is none with positions.
std::optional<fs::path> log_of(const fs::path& video) {
  const auto subtitles = subtitles_of(video);
  for (const fs::path& file : {subtitles.value_or(video), video}) {
    try {
      setup::read_log(file);
      return file;
    } catch (const Error&) {  // no log: the scene states a path of its own
    }
  }
  return std::nullopt;
}

// The frames that the scene uses, and what is known of them.
struct Part {
  std::int64_t first_frame = 0;
  std::int64_t frames = 0;
  bool is_whole = true;                     // the video's own length
  std::vector<motion::FrameMotion> motion;  // of its frames, against the first of them
  std::optional<Vector3> seen_up_in_cam;    // of the horizon in the first of them

  // Pitch and roll of a camera to which the horizon dips so; 0 without a horizon.
  YawPitchRoll attitude(double dip_rad) const {
    if (!seen_up_in_cam) return {};
    return horizon::attitude_from_up(horizon::up_from_seen(*seen_up_in_cam, dip_rad));
  }
};

std::vector<motion::FrameMotion> motion_in(const fs::path& video,
                                           const lens::Lens& lens,
                                           const NewSceneOptions& options) {
  video::Reader reader(video,
                       {.frame_count = kMaxMotionFrames,
                        .picture_rate_hz = options.picture_rate_hz,
                        .with_cuts = true},
                       options.warn);
  const std::int64_t total = std::min(kMaxMotionFrames, reader.info().frame_count_estimate);
  return setup::measure_motion(std::move(reader),
                               motion::Estimator(lens, {}, nullptr),
                               options.stop,
                               [&](std::int64_t done) {
                                 if (options.progress) options.progress(done, total);
                               });
}

Part part_of(const fs::path& video,
             const video::StreamInfo& info,
             const lens::Lens& lens,
             std::vector<motion::FrameMotion> motion) {
  Part part{.frames = info.frame_count_estimate, .motion = std::move(motion)};
  const double rate_hz = info.frame_rate.value();
  const auto wanted = static_cast<std::size_t>(std::max(1.0, kEncounterS * rate_hz));
  const double turn_rad = kSteadyShare * radians(lens.horizontal_fov_deg());
  const Stretch steady = steady_stretch(part.motion, turn_rad, wanted);
  if (steady.first > 0) {
    part.is_whole = false;
    part.first_frame = static_cast<std::int64_t>(steady.first);
    part.frames = static_cast<std::int64_t>(steady.frames);
    const Quaternion reference =
        part.motion[steady.first].rotation.value_or(Quaternion::Identity());
    const auto begin = part.motion.begin() + static_cast<std::ptrdiff_t>(steady.first);
    part.motion.assign(begin, begin + static_cast<std::ptrdiff_t>(steady.frames));
    for (motion::FrameMotion& frame : part.motion)
      if (frame.rotation) frame.rotation = *frame.rotation * reference.conjugate();
  }
  video::NumberedFrames frames(video, {});
  const image::Picture* first = frames.at(part.first_frame);
  if (first == nullptr) throw Error("holds no frame", {video.string()});
  part.seen_up_in_cam = seen_up_in(*first, lens);
  return part;
}

struct CameraWords {
  scene::Camera camera;
  std::string table;
};

// A camera with a log takes its heading, and where it has attitudes those, from it; its pitch and
// roll are else those of the horizon, which every render finds anew.
CameraWords camera_of_log(const fs::path& log,
                          const fs::path& video,
                          const Part& part,
                          const NewSceneOptions& options) {
  CameraWords words;
  words.table = fmt::format(
      "[camera]\nlog = {}                  # where the aircraft flew: airtruth log show\n",
      as_written(log, options));
  words.camera.log = log;
  setup::state_clip_start(words.camera, video, part.first_frame, options.picture_rate_hz);
  if (const auto heading = setup::level_attitude(words.camera)) {
    const YawPitchRoll level = part.attitude(setup::first_dip_rad(words.camera));
    words.camera.attitude_yaw_pitch_roll_deg =
        YawPitchRoll{heading->yaw_deg, level.pitch_deg, level.roll_deg};
  }
  return words;
}

CameraWords camera_for(const fs::path& video, const Part& part, const NewSceneOptions& options) {
  if (const auto log = log_of(video)) return camera_of_log(*log, video, part, options);
  CameraWords words;
  words.camera.position_ned_m = {0, 0, -kGuessedHeightM};
  words.camera.velocity_ned_mps = {20, 0, 0};
  const YawPitchRoll attitude = part.attitude(setup::first_dip_rad(words.camera));
  words.camera.attitude_yaw_pitch_roll_deg = YawPitchRoll{0, attitude.pitch_deg, attitude.roll_deg};
  words.table = fmt::format(
      "[camera]\n"
      "position_ned_m = [0, 0, -{0}]          # north, east, down of the first frame: {0} m high "
      "(a guess)\n"
      "velocity_ned_mps = [20, 0, 0]          # the own speed (a guess); a flight log is better: "
      "log = \"flight.srt\"\n",
      kGuessedHeightM);
  words.table +=
      part.seen_up_in_cam
          ? fmt::format(
                "attitude_yaw_pitch_roll_deg = [0, {:.1f}, {:.1f}]   # pitch and roll are those of "
                "the horizon in the first frame used: leave this line out with another "
                "first_frame\n",
                attitude.pitch_deg,
                attitude.roll_deg)
          : "attitude_yaw_pitch_roll_deg = [0, 0, 0]  # no horizon was found in the first frame\n";
  return words;
}

std::string background_words(const std::string& video,
                             const Part& part,
                             double duration_s,
                             const std::optional<double>& picture_rate_hz) {
  std::string words = fmt::format("[background]\nvideo = {}\n", video);
  if (picture_rate_hz) words += fmt::format("frame_rate_hz = {}\n", *picture_rate_hz);
  if (!part.is_whole)
    words += fmt::format(
        "first_frame = {:<25}# the camera turns away from where it looks; for these {:.1f} s it "
        "does not\nframe_count = {}\n"
        "# [motion]                             # to use the whole: this in place of the two "
        "lines above\n"
        "# reference = \"smoothed\"               # only the shake is taken from the video, and "
        "the camera looks ahead\n",
        part.first_frame,
        duration_s,
        part.frames);
  return words;
}

video::StreamInfo info_of(const fs::path& video, const NewSceneOptions& options) {
  const video::StreamInfo info =
      video::Reader(
          video, {.frame_count = 1, .picture_rate_hz = options.picture_rate_hz}, options.warn)
          .info();
  video::expect_rate(video, info, options.picture_rate_hz);
  return info;
}

// All frames of a clip whose motion ends before kMaxMotionFrames are decoded by then. Of a longer
// one whose container states no number the time stamps are counted: its length may be the sound's.
std::int64_t frames_of(const fs::path& video,
                       const video::StreamInfo& info,
                       const std::vector<motion::FrameMotion>& motion,
                       const NewSceneOptions& options) {
  if (std::ssize(motion) < kMaxMotionFrames) return std::ssize(motion);
  if (info.is_frame_count_stated) return info.frame_count_estimate;
  video::Reader reader(video, {.picture_rate_hz = options.picture_rate_hz});
  const auto count = reader.next() ? std::ssize(reader.times_s(video::kAllFrames)) : 0;
  return count > 0 ? count : info.frame_count_estimate;
}

// The known cameras whose clips are of this size, each as a line to uncomment; none where the
// file's tags tell which of them it is, since a scene takes that by itself.
std::string profile_lines(const video::StreamInfo& info) {
  if (camera_file::recognised_profile(info.width, info.height, info.tags) != nullptr) return "";
  std::string lines;
  for (const camera_file::CameraProfile& profile : camera_file::camera_profiles())
    if (profile.width == info.width && profile.height == info.height)
      lines += fmt::format(
          "# profile = {:<29}  # if it is: {}\n", '"' + profile.name + '"', profile.camera);
  return lines;
}

// An intruder that is nearest later than this begins as a dot of a pixel or two.
constexpr double kMaxApproachS = 12;

// The candidates, as a person would state them. The closest approach is near the end of the part
// that is used, so that the intruder is in front of the camera for most of it.
struct Candidate {
  double cpa_share;  // of the clip's duration, or of kMaxApproachS in a longer clip
  double course_deg;
  double speed_mps;
  double right_m;
};
constexpr std::array<Candidate, 5> kCandidates = {{{0.9, 180, 60, 40},
                                                   {0.9, 150, 60, -30},
                                                   {0.9, 90, 50, -30},
                                                   {0.9, 270, 50, 30},
                                                   {0.95, 180, 45, 20}}};
constexpr double kAboveM = 15;  // how much higher the intruder passes: chosen
constexpr int kSteps = 40;      // moments at which the view is tested

scene::Encounter encounter_of(const Candidate& candidate, double duration_s) {
  return {.cpa_time_s = candidate.cpa_share * std::min(duration_s, kMaxApproachS),
          .cpa_right_m = candidate.right_m,
          .cpa_above_m = kAboveM,
          .course_deg = candidate.course_deg,
          .speed_mps = candidate.speed_mps};
}

// At how many of the moments the intruder's reference point is in the picture; -1 where no path has
// that closest approach.
int moments_in_view(const scene::Encounter& encounter,
                    const lens::Lens& lens,
                    const trajectory::Path& own,
                    double duration_s,
                    const std::function<Shake(double)>& shake_at) {
  try {
    const trajectory::Path path = placement::path_to_approach(encounter, own);
    int count = 0;
    for (int i = 0; i <= kSteps; ++i) {
      const double time_s = std::min(duration_s, kMaxApproachS) * i / kSteps;
      const auto camera = own.at(time_s), state = path.at(time_s);
      if (!camera || !state) continue;
      const auto sight = setup::sight_of(lens, {}, own, *camera, time_s, shake_at(time_s));
      const auto pixel = projection::pixel_from_world(sight, state->position_in_world);
      if (pixel && lens.size().holds(*pixel)) ++count;
    }
    return count;
  } catch (const Error&) {
    return -1;
  }
}

// The words of an [[intruder]] with an encounter that is in view for most of a clip: of a few
// common ones (head-on, from the left, from the right, overtaken) the one whose reference point is
// in the picture longest. `shake_at` is the camera's measured motion at a time of the clip.
std::string first_encounter(const lens::Lens& lens,
                            const scene::Camera& camera,
                            double duration_s,
                            const std::function<Shake(double)>& shake_at) {
  const trajectory::Path own = setup::camera_path(camera);
  const Candidate* best = kCandidates.data();
  int most = -2;
  for (const Candidate& candidate : kCandidates) {
    const int count =
        moments_in_view(encounter_of(candidate, duration_s), lens, own, duration_s, shake_at);
    if (count > most) best = &candidate, most = count;
  }
  const scene::Encounter encounter = encounter_of(*best, duration_s);
  return fmt::format(
      "[[intruder]]\n"
      "aircraft = \"c172/g-boix\"                # airtruth aircraft list\n"
      "[intruder.encounter]\n"
      "cpa_time_s = {:<26.1f}# when the two are nearest; the clip lasts {:.1f} s\n"
      "cpa_right_m = {:<25.0f}# where it passes then: right of\n"
      "cpa_above_m = {:<25.0f}# and above the own aircraft\n"
      "course_deg = {:<26.0f}# from the own course: 180 head-on, 90 from the left, 270 from the "
      "right\n"
      "speed_mps = {:<27.0f}# along its path\n",
      encounter.cpa_time_s,
      duration_s,
      *encounter.cpa_right_m,
      encounter.cpa_above_m,
      encounter.course_deg,
      encounter.speed_mps);
}

}  // namespace

std::string scene_text(const fs::path& video, const NewSceneOptions& options) {
  const std::string background = as_written(video, options);
  video::StreamInfo info = info_of(video, options);
  const LensWords lens = lens_for(video, info, options);
  std::vector<motion::FrameMotion> motion = motion_in(video, lens.lens, options);
  info.frame_count_estimate = frames_of(video, info, motion, options);
  const Part part = part_of(video, info, lens.lens, std::move(motion));
  const CameraWords camera = camera_for(video, part, options);
  const double rate_hz = info.frame_rate.value();
  const auto seconds_of = [&](std::int64_t frames) {
    return rate_hz > 0 ? static_cast<double>(std::max<std::int64_t>(1, frames) - 1) / rate_hz : 0;
  };
  const double duration_s = seconds_of(part.frames);
  const auto shake_at = [&](double time_s) {
    const auto k = static_cast<std::size_t>(std::lround(time_s * rate_hz));
    return k < part.motion.size() ? motion::shake_of({part.motion[k]}, 0) : Shake{};
  };
  return fmt::format(
      "# {}: {}{} frames of {}x{} at {:.4g} frames/s, {:.1f} s.\n"
      "#     airtruth preview --motion THIS.toml   shows where the intruder will be\n"
      "#     airtruth render THIS.toml --out out\n"
      "# Every key: docs/formats/scene.md and examples/render.toml.\n\n"
      "{}\n"
      "# {}.\n{}\n"
      "{}\n"
      "# [realism]                              # blur, noise and haze as this camera has them\n"
      "# auto = true                            # measured from the clip, which takes a minute\n"
      "# fallback = true                        # left out, with a warning, where it cannot be\n"
      "{}\n"
      "[light]                                  # the sun, from north towards east and above the "
      "horizon\n"
      "sun_azimuth_deg = 180\nsun_elevation_deg = 45\n"
      "{}",
      video.filename().string(),
      info.is_frame_count_stated ? "" : "about ",
      info.frame_count_estimate,
      info.width,
      info.height,
      rate_hz,
      seconds_of(info.frame_count_estimate),
      background_words(background, part, duration_s, options.picture_rate_hz),
      lens.origin,
      lens.table,
      camera.table,
      profile_lines(info),
      options.has_encounter ? '\n' + first_encounter(lens.lens, camera.camera, duration_s, shake_at)
                            : "");
}

}  // namespace airtruth::new_scene
