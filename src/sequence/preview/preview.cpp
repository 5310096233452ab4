// SPDX-License-Identifier: Apache-2.0
#include "sequence/preview/preview.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "foundation/base/error.h"
#include "foundation/image/colour.h"
#include "sequence/insertion/frame_truth.h"
#include "sequence/insertion/paint.h"
#include "sequence/pipeline/resolved_scene.h"
#include "sequence/setup/flyable.h"
#include "sequence/setup/shared_inputs.h"
#include "show/drawing/draw.h"
#include "show/drawing/flight_views.h"
#include "show/drawing/pictures.h"

namespace airtruth::preview {
namespace {

// The sizes of this file are display choices.

constexpr int kWidthPx = 1960;  // that of a contact sheet of three tiles
// Widths of the picture at the left and of the plan and the heights at its right, 10 px apart.
constexpr int kMainWidthPx = 1270;
constexpr int kSideWidthPx = kWidthPx - kMainWidthPx - 10;
// The height of the picture at most, and of the plan and the heights together at least.
constexpr int kMainHeightPx = 1600;
constexpr int kSideHeightPx = 300;
// Number of moments that are shown: the contact sheet has as many tiles in a row.
constexpr std::size_t kTiles = 3;
constexpr double kPathStepS = 0.05;  // between the points of a drawn path: chosen

// What the pictures are made from.
class Previewer {
 public:
  Previewer(const scene::Scene& scene, const pipeline::Options& options)
      : options_(options),
        opened_(pipeline::open_scene(scene, options)),
        parties_(parties_of(opened_.stated.scene)),
        motion_(known_motion()),
        painter_(opened_.stated.scene, world(), opened_.occluders, nullptr, options.stop),
        rate_hz_(opened_.info.frame_rate.value()),
        times_s_(
            opened_.background->times_s(scene.background.frame_count.value_or(video::kAllFrames))),
        frames_(times_s_.empty() ? opened_.info.frame_count_estimate : std::ssize(times_s_)),
        duration_s_(video::are_of_rate(times_s_, rate_hz_)
                        ? static_cast<double>(std::max<std::int64_t>(0, frames_ - 1)) / rate_hz_
                        : times_s_.back()) {
    check_seen();
    if (motion_) pipeline::place_seen(opened_, *motion_, options.stop);
  }

  Preview make() {
    warn_of_length();
    // What cannot be flown is said before it is rendered.
    setup::warn_below_ground(scene(), world(), duration_s_, options_.warn);
    for (std::size_t i = 0; i < world().actors.size(); ++i)
      setup::warn_not_flyable(
          scene().intruders[i], world().actors[i].path, duration_s_, options_.warn);
    Preview result;
    const std::vector<double> times = whole_seconds(duration_s_);
    result.has_motion = motion_.has_value();
    result.notes = opened_.notes;
    result.rows =
        preview_rows(world(), parties_, times, [&](double time_s) { return moment(time_s); });
    std::set<std::size_t> seen;
    for (const PreviewRow& row : result.rows)
      if (row.box_px) seen.insert(row.party);
    result.approaches = approach_lines(world(), parties_, seen, duration_s_);
    const auto times_seen = times_in_view(result.rows);
    std::vector<cv::Mat> parts = {title(result.approaches), top(result.rows, times_seen)};
    if (!times_seen.empty()) parts.push_back(moments(chosen(times_seen)));
    parts.push_back(table(result.rows));
    result.picture = stacked(parts);
    return result;
  }

 private:
  const scene::Scene& scene() const { return opened_.stated.scene; }
  const setup::World& world() const { return opened_.world; }

  // The motion that an earlier run has measured; empty without one.
  std::optional<setup::MotionSource> known_motion() const {
    return setup::MotionSource::from_cache(pipeline::motion_inputs(
        opened_, setup::sha256_of_video(scene().background.video, *opened_.inputs), options_));
  }
  // render() refuses what no frame is at.
  void check_seen() const {
    if (frames_ <= 0 || opened_.info.variable_frame_rate) return;
    for (const scene::Intruder& intruder : scene().intruders)
      for (const scene::Seen& seen : intruder.seen)
        if (seen.time_s > duration_s_ + 1 / rate_hz_)
          throw Error(fmt::format("time_s is {:.3f}, where the clip has no frame: it ends at "
                                  "{:.3f} s; expected a time within the clip",
                                  seen.time_s,
                                  duration_s_),
                      seen.where);
  }
  void warn_of_length() const {
    const scene::Background& background = scene().background;
    if (options_.warn && frames_ > 0 && background.frame_count.value_or(0) > frames_)
      options_.warn(
          fmt::format("[background] frame_count is {}, and first_frame {}; the clip has only {} "
                      "frames from there",
                      *background.frame_count,
                      background.first_frame,
                      frames_));
  }
  void stop_if_asked() const {
    if (options_.stop.stop_requested()) throw Interrupted();
  }

  // The whole seconds at which an intruder is in view, each once, in order.
  static std::vector<double> times_in_view(const std::vector<PreviewRow>& rows) {
    std::vector<double> times;
    for (const PreviewRow& row : rows)
      if (row.box_px && (times.empty() || row.time_s > times.back())) times.push_back(row.time_s);
    return times;
  }

  // As many of the times as there are tiles, evenly spread, with the first and the last.
  static std::vector<double> chosen(const std::vector<double>& times) {
    if (times.size() <= kTiles) return times;
    std::vector<double> result;
    for (std::size_t i = 0; i < kTiles; ++i)
      result.push_back(times[i * (times.size() - 1) / (kTiles - 1)]);
    return result;
  }

  // The light in a frame; each frame is looked at alone.
  insertion::Ambient ambient_in(const image::Picture& picture, const setup::Moment& moment) const {
    return insertion::AmbientEstimator(scene().light, scene().camera_model, opened_.mask.get())
        .next(picture, moment.sight, setup::search_bounds(moment));
  }

  video::Frame frame_at(double time_s) {
    stop_if_asked();
    auto frame = opened_.background->at(time_s);
    if (!frame)
      throw Error(fmt::format("holds no frame at {:.2f} s", time_s),
                  {scene().background.video.string()});
    return std::move(*frame);
  }

  Shake shake_at(double time_s) const { return motion_ ? motion_->nearest(time_s).shake : Shake{}; }

  // The number of the last frame that does not begin after a time; empty where the video does not
  // say when its frames are shown.
  std::optional<std::int64_t> number_at(double time_s) const {
    if (times_s_.empty()) return std::nullopt;
    return std::max<std::int64_t>(
        0, std::ranges::upper_bound(times_s_, time_s) - times_s_.begin() - 1);
  }

  setup::Moment moment(double time_s) const {
    // Reader::at() takes the frame that begins within half an interval after the time.
    const auto number = number_at(time_s + 0.5 / rate_hz_);
    return setup::moment_at(
        world(), number.value_or(std::llround(time_s * rate_hz_)), time_s, shake_at(time_s));
  }

  // The camera alone: what a point of a path needs.
  projection::Sight sight_at(double time_s) const {
    const auto camera = world().camera.at(time_s);
    if (!camera) return moment(time_s).sight;  // says what is wrong
    return setup::sight_of(
        world().lens, world().shutter, world().camera, *camera, time_s, shake_at(time_s));
  }

  // The time whose frame stands behind the paths: that of the nearest intruder in view.
  double main_time(const std::vector<PreviewRow>& rows) const {
    const PreviewRow* nearest = nullptr;
    for (const PreviewRow& row : rows)
      if (row.box_px && (nearest == nullptr || row.nearest.range_m < nearest->nearest.range_m))
        nearest = &row;
    return nearest != nullptr ? nearest->time_s : 0;
  }

  // One frame with the intruders drawn at every second at which they are seen, the farthest first.
  cv::Mat main_picture(const std::vector<PreviewRow>& rows, const std::vector<double>& seen) {
    video::Frame frame = frame_at(main_time(rows));
    const insertion::Ambient ambient = ambient_in(frame.picture, moment(main_time(rows)));
    std::map<double, double> range_at;
    for (const PreviewRow& row : rows)
      if (row.box_px) range_at[row.time_s] = std::max(range_at[row.time_s], row.nearest.range_m);
    std::vector<double> order = seen;
    std::ranges::stable_sort(
        order, std::ranges::greater(), [&](double time_s) { return range_at[time_s]; });
    for (const double time_s : order) {
      stop_if_asked();
      setup::Moment here = moment(time_s);
      // What is on the lens covers the picture once.
      if (time_s != order.back()) here.spots.clear();
      painter_.paint(frame.picture, here, ambient);
    }
    image::Rgb8 rgb = image::rgb8_from_picture(frame.picture);
    const double scale = std::min(static_cast<double>(kMainWidthPx) / rgb.width,
                                  static_cast<double>(kMainHeightPx) / rgb.height);
    const image::Rgb8 scaled =
        drawing::scaled(rgb, scale, scale < 1 ? cv::INTER_AREA : cv::INTER_LINEAR);
    cv::Mat canvas = image::mat_of(scaled).clone();
    for (std::size_t i = 0; i < parties_.size(); ++i) draw_path(canvas, i, scale);
    draw_ticks(canvas, scale);
    return canvas;
  }

  // Pixels of the frame along the upper and the left edge, from which `seen` can be read.
  static void draw_ticks(cv::Mat& canvas, double scale) {
    // Least distance between two ticks, their length, and the size of their numbers, in px of the
    // canvas.
    constexpr int kApartPx = 90, kTickPx = 8;
    constexpr double kTextPx = 11;
    double step = 10;
    while (step * scale < kApartPx) step *= 2;
    for (int i = 0; i * step * scale < std::max(canvas.cols, canvas.rows); ++i) {
      const int at = static_cast<int>(std::lround(i * step * scale));
      const std::string words = fmt::format("{:.0f}", i * step);
      if (at + drawing::text_width(words, kTextPx) < canvas.cols) {
        cv::line(canvas, {at, 0}, {at, kTickPx}, drawing::kWhite);
        drawing::text(canvas, words, at + 3, 13, kTextPx, drawing::kWhite);
      }
      if (i == 0 || at + kTickPx > canvas.rows) continue;
      cv::line(canvas, {0, at}, {kTickPx, at}, drawing::kWhite);
      drawing::text(canvas, words, kTickPx + 3, at + 4, kTextPx, drawing::kWhite);
    }
  }

  // The pixels of an intruder's centre, each in the frame of its time, joined, with the seconds
  // beside them.
  void draw_path(cv::Mat& canvas, std::size_t party, double scale) const {
    const trajectory::Path& path = world().actors[parties_[party].middle].path;
    const cv::Scalar colour = drawing::intruder_colour(party);
    std::optional<cv::Point> before;
    const auto steps = static_cast<int>(duration_s_ / kPathStepS);
    for (int i = 0; i <= steps; ++i) {
      const double time_s = kPathStepS * i;
      const auto state = path.at(time_s);
      const auto pixel =
          state ? projection::pixel_from_world(sight_at(time_s), state->position_in_world)
                : std::nullopt;
      const bool is_near = pixel && std::abs(pixel->x()) < 4 * world().lens.size().width &&
                           std::abs(pixel->y()) < 4 * world().lens.size().height;
      if (!is_near) {
        before.reset();
        continue;
      }
      const cv::Point here(static_cast<int>(std::lround(pixel->x() * scale)),
                           static_cast<int>(std::lround(pixel->y() * scale)));
      if (before) cv::line(canvas, *before, here, colour, 1, cv::LINE_AA);
      if (i % static_cast<int>(std::lround(1 / kPathStepS)) == 0) {
        cv::circle(canvas, here, 3, colour, 1, cv::LINE_AA);
        drawing::text(canvas, fmt::format("{:.0f}", time_s), here.x + 6, here.y - 6, 11, colour);
      }
      before = here;
    }
  }

  drawing::FlightLine flight_of(const std::string& name,
                                const trajectory::Path& path,
                                const cv::Scalar& colour) const {
    drawing::FlightLine line{name, colour, {}, {}};
    const double step_s = std::max(0.1, std::ceil(duration_s_ / 60) * 0.1);
    for (int i = 0; step_s * i <= duration_s_ + 1e-9; ++i)
      if (const auto state = path.at(step_s * i)) {
        line.times_s.push_back(step_s * i);
        line.positions_ned_m.push_back(state->position_in_world);
      }
    return line;
  }

  // The main picture with plan and height at its right.
  cv::Mat top(const std::vector<PreviewRow>& rows, const std::vector<double>& seen) {
    const cv::Mat main = main_picture(rows, seen);
    std::vector<drawing::FlightLine> lines = {flight_of("own", world().camera, drawing::kWhite)};
    for (std::size_t i = 0; i < parties_.size(); ++i)
      lines.push_back(flight_of(
          parties_[i].name, world().actors[parties_[i].middle].path, drawing::intruder_colour(i)));
    const int height_px = std::max(main.rows, kSideHeightPx);
    const int plan_px = height_px * 2 / 3;
    const auto camera = world().camera.at(0);
    image::Rgb8 plan = drawing::plan_view(lines,
                                          yaw_pitch_roll(camera->world_from_body).yaw_deg,
                                          view_deg(world()),
                                          kSideWidthPx,
                                          plan_px);
    image::Rgb8 height = drawing::height_view(lines, kSideWidthPx, height_px - plan_px);
    cv::Mat canvas(height_px, kWidthPx, CV_8UC3, drawing::kDarkPaper);
    main.copyTo(canvas(cv::Rect(0, 0, main.cols, main.rows)));
    image::mat_of(plan).copyTo(canvas(cv::Rect(kWidthPx - kSideWidthPx, 0, kSideWidthPx, plan_px)));
    image::mat_of(height).copyTo(
        canvas(cv::Rect(kWidthPx - kSideWidthPx, plan_px, kSideWidthPx, height_px - plan_px)));
    return canvas;
  }

  // Frames of single moments with the intruders enlarged.
  cv::Mat moments(const std::vector<double>& times) {
    drawing::ContactSheet sheet("", static_cast<std::int64_t>(times.size()), times.size());
    for (std::size_t i = 0; i < times.size(); ++i) {
      video::Frame frame = frame_at(times[i]);
      const setup::Moment here = moment(times[i]);
      const insertion::Painted painted =
          painter_.paint(frame.picture, here, ambient_in(frame.picture, here));
      frame.index = number_at(frame.time_s).value_or(here.frame);
      annotation::Frame truth = insertion::frame_truth(world(), frame, "none", {}, here, painted);
      sheet.add(frame.picture, truth);
    }
    image::Rgb8 picture = sheet.sheet();
    return image::mat_of(picture).clone();
  }

  cv::Mat table(const std::vector<PreviewRow>& rows) const {
    std::vector<drawing::TableRow> shown;
    for (const PreviewRow& row : rows)
      shown.push_back({drawing::intruder_colour(row.party), table_cells(row)});
    image::Rgb8 picture = drawing::table_picture(table_heading(), shown, kWidthPx);
    return image::mat_of(picture).clone();
  }

  cv::Mat title(const std::vector<std::string>& lines) const {
    // Height of a line of the title, whose letters have 13 px.
    constexpr int kLinePx = 22;
    cv::Mat canvas(
        40 + kLinePx * static_cast<int>(lines.size()), kWidthPx, CV_8UC3, drawing::kDarkPaper);
    drawing::text(
        canvas,
        drawing::fitted(fmt::format("{}: {:.1f} s of {} at {:.4g} frames/s, {}",
                                    scene().name,
                                    duration_s_,
                                    scene().background.video.filename().string(),
                                    rate_hz_,
                                    motion_ ? "each moment with the camera's measured motion"
                                            : "the camera's shake not shown"),
                        16,
                        kWidthPx - 24),
        12,
        26,
        16,
        drawing::kWhite);
    for (std::size_t i = 0; i < lines.size(); ++i)
      drawing::text(canvas,
                    drawing::fitted(lines[i], 13, kWidthPx - 24),
                    12,
                    48 + kLinePx * static_cast<int>(i),
                    13,
                    drawing::intruder_colour(i));
    return canvas;
  }

  static image::Rgb8 stacked(const std::vector<cv::Mat>& parts) {
    int height = 0;
    for (const cv::Mat& part : parts) height += part.rows + 6;
    cv::Mat canvas(height, kWidthPx, CV_8UC3, drawing::kDarkPaper);
    int y = 0;
    for (const cv::Mat& part : parts) {
      const int width = std::min(part.cols, kWidthPx);
      part(cv::Rect(0, 0, width, part.rows)).copyTo(canvas(cv::Rect(0, y, width, part.rows)));
      y += part.rows + 6;
    }
    return image::rgb8_of(canvas);
  }

  const pipeline::Options& options_;
  pipeline::OpenedScene opened_;
  std::vector<Party> parties_;
  std::optional<setup::MotionSource> motion_;
  insertion::Painter painter_;
  double rate_hz_;
  std::vector<double> times_s_;  // when the video shows each frame, as far as it says so
  // Those that the scene uses: counted, or else as the container gives them, whose length may be
  // that of the sound.
  std::int64_t frames_;
  double duration_s_;  // from the first of them to the last
};

}  // namespace

Preview preview_of(const scene::Scene& scene, const pipeline::Options& options) {
  pipeline::Options plain = options;
  plain.is_preview = true;
  return Previewer(scene, plain).make();
}

}  // namespace airtruth::preview
