// SPDX-License-Identifier: Apache-2.0
#include "comparison/comparison/comparison.h"

#include <algorithm>
#include <iterator>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "aircraft/fleet/fleet.h"
#include "comparison/appearance/background_shift.h"
#include "comparison/appearance/looks.h"
#include "comparison/appearance/segment.h"
#include "comparison/comparison/measures.h"
#include "comparison/match/place.h"
#include "comparison/match/pose.h"
#include "comparison/match/real.h"
#include "comparison/match/sun.h"
#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/base/median.h"
#include "foundation/geometry/box.h"
#include "foundation/geometry/units.h"
#include "foundation/image/colour.h"
#include "foundation/image/mats.h"
#include "labels/annotation/truth.h"
#include "picture/video/reader.h"
#include "picture/video/still.h"
#include "scene/trajectory/path.h"
#include "sequence/pipeline/render.h"
#include "sequence/pipeline/staged_folder.h"
#include "sequence/setup/from_scene.h"
#include "sequence/setup/world.h"
#include "show/drawing/draw.h"

namespace airtruth::comparison {
namespace {

// Where a constant of this file states no origin, it is a choice.

constexpr const char* kName = "sequence";
constexpr std::size_t kPoseMasks = 5;      // that a pose is fitted to
constexpr double kPoorOverlap = 0.5;       // of silhouettes: said in a warning below it
constexpr std::int64_t kSizingFrames = 9;  // that the inserted aircraft's size is set by
constexpr std::size_t kSunFrames = 2;      // that the sun is fitted to
constexpr std::size_t kMaxPaints = 6;      // liveries of a type that are tried
constexpr double kPoseSpacingDeg = 40;     // of the suns that a pose or a livery is tried under
constexpr double kSunSpacingDeg = 15;      // of those that the best of them is

// Level flight as fast as aircraft are loaded by default: gear and flaps that a model moves by its
// speed are up, as those of the silhouettes are to which a pose is fitted.
Vector3 cruise_mps(double yaw_deg) {
  return world_from_body({yaw_deg, 0, 0}) *
         Vector3(model::LoadOptions().airspeed_kt * kMpsOfKnot, 0, 0);
}

// The scene with its first intruder beside the real aircraft, and nothing else in the air.
scene::Scene scene_beside(const scene::Scene& given,
                          const fs::path& real,
                          const match::RealBoxes& boxes,
                          const match::Beside& path,
                          const YawPitchRoll& attitude,
                          double camera_pitch_deg) {
  scene::Scene scene = given;
  scene.name = kName;
  scene.background.video = real;
  scene.background.first_frame = boxes.begin()->first;
  scene.background.frame_count = boxes.rbegin()->first - boxes.begin()->first + 1;
  scene.camera = {};
  scene.camera.position_ned_m = Vector3::Zero();
  scene.camera.velocity_ned_mps = path.camera_velocity_ned_mps;
  scene.camera.attitude_yaw_pitch_roll_deg = YawPitchRoll{0, camera_pitch_deg, 0};
  scene.motion.model = scene::MotionModel::kNone;
  scene.intruders.resize(1);
  scene.lens_marks.clear();
  scene::Intruder& intruder = scene.intruders[0];
  intruder.path_file.reset();
  intruder.encounter.reset();
  intruder.seen.clear();
  intruder.waypoints_ned_m = path.waypoints_ned_m;
  intruder.times_s = path.times_s;
  intruder.speed_mps.reset();
  intruder.start_s = 0;
  intruder.yaw_deg = attitude.yaw_deg;
  intruder.pitch_deg = attitude.pitch_deg;
  intruder.roll_deg = attitude.roll_deg;
  scene.output.video = video::Format::kMkv;  // what is compared is not encoded once more
  return scene;
}

// The sizes of the figure are display choices.

constexpr int kSmallPx = 44;    // of a crop at 1x, at most
constexpr int kMinCropPx = 24;  // beyond it stands the other one of a pair
constexpr int kLargePx = 352;   // of an enlarged crop
// Gaps between pictures, and heights of a heading and of its letters.
constexpr int kGapPx = 10;
constexpr int kHeadingPx = 34;
constexpr double kTextPx = 14;

// A square crop of the frame around a box.
struct Crop {
  image::Rgb8 picture;
  Box box;  // in pixels of the crop
};

struct FigureRow {
  std::int64_t frame = 0;
  Crop real, made;
};

Crop crop_of(const image::Picture& picture, const Box& box, int side) {
  const int x = whole_pixels(box.x + box.width / 2) - side / 2;
  const int y = whole_pixels(box.y + box.height / 2) - side / 2;
  return {image::rgb8_from_picture(picture, {x, y, side, side}),
          {box.x - x, box.y - y, box.width, box.height}};
}

// Makes both crops of a pair with the same size: the larger box, with a margin of its own size
// around it.
FigureRow figure_row(const image::Picture& picture,
                     std::int64_t frame,
                     const Box& real,
                     const Box& made) {
  const double larger = std::max({real.width, real.height, made.width, made.height});
  const int side = std::clamp(whole_pixels(2 * larger), kMinCropPx, picture.width);
  return {frame, crop_of(picture, real, side), crop_of(picture, made, side)};
}

// Shows the real aircraft at 1x and enlarged with its box, and the inserted one likewise; one row
// per frame, in two columns.
image::Rgb8 figure_of(const std::vector<FigureRow>& rows) {
  // Width of a pair of crops, each in two sizes.
  constexpr int kPairPx = 4 * kGapPx + 2 * (kSmallPx + kLargePx);
  const int columns = rows.size() > 1 ? 2 : 1;
  const int lines = (static_cast<int>(rows.size()) + columns - 1) / columns;
  cv::Mat canvas(kHeadingPx + lines * (kLargePx + kHeadingPx),
                 columns * (kPairPx + 2 * kGapPx),
                 CV_8UC3,
                 drawing::kDarkPaper);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    int x = kGapPx + static_cast<int>(i) % columns * (kPairPx + 2 * kGapPx);
    const int y = kHeadingPx + static_cast<int>(i) / columns * (kLargePx + kHeadingPx);
    for (const Crop* one : {&rows[i].real, &rows[i].made}) {
      const std::string name =
          one == &rows[i].real ? fmt::format("real, frame {}", rows[i].frame) : "inserted";
      drawing::text(canvas,
                    fmt::format("{}, {:.0f} x {:.0f} px", name, one->box.width, one->box.height),
                    x,
                    y - 8,
                    kTextPx,
                    drawing::kWhite);
      // At 1x as much as there is room for, from the middle.
      const cv::Mat crop = image::mat_of(one->picture);
      const int small = std::min(kSmallPx, crop.cols);
      const int from = (crop.cols - small) / 2;
      crop(cv::Rect(from, from, small, small)).copyTo(canvas(cv::Rect(x, y, small, small)));
      x += kSmallPx + kGapPx;
      cv::Mat large = canvas(cv::Rect(x, y, kLargePx, kLargePx));
      const int method = crop.cols > kLargePx ? cv::INTER_AREA : cv::INTER_NEAREST;
      cv::resize(crop, large, large.size(), 0, 0, method);
      drawing::outline(large, one->box, double(kLargePx) / crop.cols, drawing::kGreen);
      x += kLargePx + kGapPx;
    }
  }
  return image::rgb8_of(canvas);
}

// Both crops of a pair as they are: the real aircraft at the left, the inserted one at the right.
image::Rgb8 patches_of(const FigureRow& row) {
  cv::Mat both;
  cv::hconcat(image::mat_of(row.real.picture), image::mat_of(row.made.picture), both);
  return image::rgb8_of(both);
}

class Comparing {
 public:
  Comparing(const fs::path& real,
            const match::RealBoxes& boxes,
            const scene::Scene& scene,
            const fs::path& out,
            const Options& options)
      : real_(real), options_(options), staged_(out, options.overwrite, options.warn) {
    require_utf8(fs::absolute(real));
    if (scene.intruders.empty() || !is_aircraft(scene.intruders[0]))
      throw Error("has no intruder to compare", {scene.file.string()});
    const match::RealAircraft found =
        match::find_real(real, boxes, options.most_frames, options.warn, options.stop);
    boxes_ = found.boxes;
    scene::Scene matched = scene;
    if (options.match)
      match(found.masks, matched);
    else
      load(matched);
    const double scale = fitting_scale(matched);
    render_beside(matched, boxes_, scale, staged_.path(), true);
    compare();
  }

  Comparison finish(const fs::path& out) {
    if (all_.empty())
      throw Error("no frame shows both aircraft whole with room around them", {real_.string()});
    Comparison result;
    result.folder = out;
    result.frames = static_cast<std::int64_t>(all_.size());
    result.pairs = pairs_of(all_);
    result.pose = pose_;
    result.sun = sun_;
    std::vector<double> between, within;
    for (std::size_t i = 0; i < all_.size(); ++i) {
      between.push_back(appearance::distance(all_[i].real.histogram, all_[i].made.histogram));
      within.push_back(appearance::distance(
          all_[i].real.histogram, all_[(i + all_.size() / 2) % all_.size()].real.histogram));
    }
    result.colour_distance = median_between(std::move(between));
    result.colour_distance_within = median_between(std::move(within));
    const fs::path& part = staged_.path();
    video::write_still(part / "figure.png", figure_of(figure_));
    write_file(part / "comparison.md", table_of(result));
    write_file(part / "patches.csv", patches_csv(all_));
    write_file(part / "comparison.json", json_of(result, real_));
    staged_.commit();
    return result;
  }

 private:
  void load(scene::Scene& given) {
    const video::StreamInfo info =
        video::Reader(real_, {.picture_rate_hz = given.background.frame_rate_hz, .threads = 1})
            .info();
    const lens::ImageSize size{info.width, info.height};
    setup::take_pixel_shape(given.lens, size, info.sample_aspect.value());
    lens_ = setup::lens_of(given.lens, size);
    rate_hz_ = info.frame_rate.value();
    const scene::Intruder& intruder = given.intruders[0];
    const trajectory::Path level = trajectory::uniform(Vector3::Zero(), cruise_mps(0), {});
    aircraft_ = setup::aircraft_of(intruder, level, options_.warn, options_.stop);
    attitude_ = {intruder.yaw_deg.value_or(90),
                 intruder.pitch_deg.value_or(0),
                 intruder.roll_deg.value_or(0)};
    if (pose_) pose_->attitude = attitude_ = attitude_beside();
  }

  // Type, attitude, livery and sun of the real aircraft, as far as they can be measured:
  // silhouettes, by masks around the middle of the shot, leave a few poses; of these the one is
  // taken, and the livery and sun, that is light, dark and coloured where the real one is.
  void match(const std::map<std::int64_t, cv::Mat>& masks, scene::Scene& scene) {
    std::vector<cv::Mat> few;
    auto it = std::next(masks.begin(), static_cast<std::ptrdiff_t>(masks.size() / 2));
    for (; it != masks.end() && few.size() < kPoseMasks; ++it) few.push_back(it->second);
    const std::vector<match::PoseFit> fits = match::fit_types(
        few,
        options_.types.empty() ? match::types_to_match(options_.helicopter) : options_.types,
        options_.warn,
        options_.stop);
    take(fits[0], scene);
    const std::vector<video::Frame> read = frames_of_the_middle();
    const std::vector<match::SunFrame> frames = sun_frames(read);
    if (!frames.empty()) match_light(fits, frames, scene);
    if (pose_->overlap < kPoorOverlap)
      warn(options_.warn,
           fmt::format("{}: no silhouette fits the real aircraft's well: the best, {}, overlaps it "
                       "by {:.2f}; --types names others",
                       real_.string(),
                       pose_->aircraft,
                       pose_->overlap));
  }

  void take(const match::PoseFit& fit, scene::Scene& scene) {
    pose_ = fit;
    scene::Intruder& intruder = scene.intruders[0];
    intruder.aircraft = fit.aircraft;
    // Axes and scales are those of the scene's own aircraft.
    intruder.model_forward.reset();
    intruder.model_up.reset();
    intruder.model_scale.reset();
    intruder.catalogue_scale.reset();
    load(scene);
  }

  // The found attitude is as seen straight ahead; where the aircraft is placed, the line of sight
  // turns, and the aircraft with it.
  YawPitchRoll attitude_beside() const {
    const Box& box =
        std::next(boxes_.begin(), static_cast<std::ptrdiff_t>(boxes_.size() / 2))->second;
    const auto ray = lens_->ray_from_pixel(centre_of(box));
    if (!ray) return pose_->attitude;
    const Vector3 sight = cam_from_body().conjugate() * *ray;
    const Quaternion turn = Quaternion::FromTwoVectors(Vector3::UnitX(), sight);
    return yaw_pitch_roll(turn * world_from_body(pose_->attitude));
  }

  // The scene of an intruder beside the real one in the frames of `boxes`.
  scene::Scene placed_beside(const scene::Scene& given,
                             const match::RealBoxes& boxes,
                             double scale) const {
    match::Beside path =
        match::path_beside(boxes, aircraft_.mesh, attitude_, *lens_, rate_hz_, scale);
    const double pitch_deg = options_.camera_pitch_deg.value_or(match::camera_pitch_deg(attitude_));
    YawPitchRoll attitude = attitude_;
    match::look_up(pitch_deg, path, attitude);
    match::set_off(cruise_mps(attitude.yaw_deg), path);
    return scene_beside(given, real_, boxes, path, attitude, pitch_deg);
  }

  // Boxes from the middle of the shot: the picture's edges and the first frames of a codec are not
  // like the rest.
  match::RealBoxes middle_boxes() const {
    const auto from = std::next(boxes_.begin(), static_cast<std::ptrdiff_t>(boxes_.size() / 2));
    return {from, boxes_.lower_bound(from->first + kSizingFrames)};
  }

  std::vector<video::Frame> frames_of_the_middle() const {
    const match::RealBoxes few = middle_boxes();
    std::vector<video::Frame> read;
    if (few.size() < 2) return read;
    video::Reader reader(
        real_, {.first_frame = few.begin()->first, .frame_count = kSizingFrames, .threads = 1});
    while (auto frame = reader.next()) read.push_back(std::move(*frame));
    return read;
  }

  std::vector<match::SunFrame> sun_frames(const std::vector<video::Frame>& read) const {
    std::vector<match::SunFrame> frames;
    const match::RealBoxes few = middle_boxes();
    for (const auto& [index, box] : few)
      if (const auto k = static_cast<std::size_t>(index - few.begin()->first);
          k < read.size() && frames.size() < kSunFrames)
        frames.push_back({double(k) / rate_hz_, &read[k].picture, box});
    return frames;
  }

  void match_light(const std::vector<match::PoseFit>& fits,
                   const std::vector<match::SunFrame>& frames,
                   scene::Scene& scene) {
    const std::vector<match::SunFrame> one = {frames[0]};
    const auto fit_now = [&](const std::vector<match::SunFrame>& in, double spacing_deg) {
      return match::fit_sun(
          placed_beside(scene, middle_boxes(), 1), in, spacing_deg, options_.stop);
    };
    // A pose that overlaps less has to be the more alike.
    std::size_t best = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < fits.size(); ++i) {
      take(fits[i], scene);
      const auto sun = fit_now(one, kPoseSpacingDeg);
      if (!sun || !(sun->difference_codes < least * fits[i].overlap)) continue;
      least = sun->difference_codes / fits[i].overlap;
      best = i;
    }
    take(fits[best], scene);
    match::PoseFit painted = fits[best];
    least = std::numeric_limits<double>::infinity();
    for (const std::string& name : paints_of(fits[best].aircraft)) {
      scene.intruders[0].aircraft = name;
      const auto sun = fit_now(one, kPoseSpacingDeg);
      if (sun && sun->difference_codes < least)
        least = sun->difference_codes, painted.aircraft = name;
    }
    take(painted, scene);
    sun_ = fit_now(frames, kSunSpacingDeg);
    if (!sun_) return;
    scene.light.sun_azimuth_deg = sun_->azimuth_deg;
    scene.light.sun_elevation_deg = sun_->elevation_deg;
    scene.light.sun_is_stated = true;
  }

  // The type as it was found, and other liveries of it, evenly from the list of all; the type alone
  // where the user names the types.
  std::vector<std::string> paints_of(const std::string& type) const {
    std::vector<std::string> paints = {type};
    if (!options_.types.empty()) return paints;
    const std::vector<std::string> others = fleet::liveries(type);
    const std::size_t count = std::min(kMaxPaints - 1, others.size());
    for (std::size_t i = 0; i < count; ++i) paints.push_back(others[i * others.size() / count]);
    return paints;
  }

  void render_beside(const scene::Scene& given,
                     const match::RealBoxes& boxes,
                     double scale,
                     const fs::path& folder,
                     bool reports) {
    pipeline::Options how;
    // The path is that of a place in the picture; that no aircraft can fly it is no news.
    if (reports)
      how.warn = [this](const std::string& message) {
        if (message.find("cannot fly its path") == std::string::npos) warn(options_.warn, message);
      };
    how.stop = options_.stop;
    if (reports)
      how.progress = [&](const pipeline::Progress& p) {
        if (options_.progress) options_.progress(p.frames_done, 2 * p.frames_total);
      };
    pipeline::render(placed_beside(given, boxes, scale), folder, how);
  }

  // What the inserted aircraft's size must be multiplied by to look as large as the real one, both
  // by what stands out: blur and codec make a silhouette larger than geometry says.
  double fitting_scale(const scene::Scene& given) {
    const match::RealBoxes few = middle_boxes();
    if (few.size() < 2) return 1;
    const fs::path folder = staged_.path() / "sizing";
    render_beside(given, few, 1, folder, false);
    std::vector<double> ratios;
    each_pair(folder / kName, few, [&](const PairSeen& pair) {
      const auto larger = [](const Box& box) { return std::max(box.width, box.height); };
      ratios.push_back(larger(pair.real) / larger(pair.made));
    });
    fs::remove_all(folder);
    return ratios.empty() ? 1 : std::clamp(median(ratios), 0.5, 1.5);
  }

  struct PairSeen {
    std::int64_t frame = 0;
    const image::Picture* picture = nullptr;
    Box real, made;  // tight
  };

  // Every frame of a rendered folder in which both aircraft stand out whole.
  template <typename Use>
  void each_pair(const fs::path& folder, const match::RealBoxes& boxes, const Use& use) {
    const annotation::Truth truth = annotation::read_truth(folder / "truth.jsonl");
    video::Reader reader(folder / (std::string(kName) + ".mkv"));
    const std::int64_t first = boxes.begin()->first;
    while (const auto frame = reader.next()) {
      if (options_.stop.stop_requested()) throw Interrupted();
      const auto box = boxes.find(first + frame->index);
      if (box == boxes.end() || frame->index >= static_cast<std::int64_t>(truth.frames.size()))
        continue;
      const annotation::Intruder& made =
          truth.frames[static_cast<std::size_t>(frame->index)].intruders[0];
      if (!made.visible_box_px || !made.exact_box_px || made.cut_by_frame > 0) continue;
      const auto seen = appearance::seen_in(frame->picture, *made.exact_box_px);
      if (seen) use(PairSeen{box->first, &frame->picture, box->second, seen->box});
    }
  }

  void compare() {
    const std::int64_t first = boxes_.begin()->first;
    const std::int64_t total = boxes_.rbegin()->first - first + 1;
    const std::int64_t every = std::max<std::int64_t>(1, total / std::max(1, options_.pairs));
    const fs::path patches = staged_.path() / "patches";
    fs::create_directory(patches);
    appearance::BackgroundShift background;
    std::int64_t before = -2;
    each_pair(staged_.path() / kName, boxes_, [&](const PairSeen& pair) {
      if (options_.progress) options_.progress(total + pair.frame - first, 2 * total);
      auto shift = background.add(*pair.picture, {pair.real, pair.made});
      if (pair.frame != before + 1) shift.reset();
      before = pair.frame;
      const auto real_patch = appearance::patch_of(*pair.picture, pair.real);
      const auto made_patch = appearance::patch_of(*pair.picture, pair.made);
      if (!real_patch || !made_patch) return;
      if (cv::countNonZero(real_patch->silhouette) == 0 ||
          cv::countNonZero(made_patch->silhouette) == 0)
        return;
      all_.push_back({pair.frame,
                      appearance::looks_of(*real_patch),
                      appearance::looks_of(*made_patch),
                      shift});
      FigureRow row = figure_row(*pair.picture, pair.frame, pair.real, pair.made);
      video::write_still(patches / fmt::format("{:06}.png", pair.frame), patches_of(row));
      if (figure_.size() < static_cast<std::size_t>(options_.pairs) &&
          (figure_.empty() || pair.frame >= figure_.back().frame + every))
        figure_.push_back(std::move(row));
    });
  }

  fs::path real_;
  match::RealBoxes boxes_;  // tight
  Options options_;
  pipeline::StagedFolder staged_;
  std::optional<lens::Lens> lens_;
  double rate_hz_ = 0;
  fleet::Aircraft aircraft_;
  YawPitchRoll attitude_;
  std::optional<match::PoseFit> pose_;
  std::optional<match::SunFit> sun_;
  std::vector<Compared> all_;
  std::vector<FigureRow> figure_;
};

}  // namespace

Comparison compare(const fs::path& real,
                   const match::RealBoxes& boxes,
                   const scene::Scene& scene,
                   const fs::path& out,
                   const Options& options) {
  return Comparing(real, boxes, scene, out, options).finish(out);
}

}  // namespace airtruth::comparison
