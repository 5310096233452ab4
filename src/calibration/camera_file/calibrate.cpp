// SPDX-License-Identifier: Apache-2.0
#include "calibration/camera_file/calibrate.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "calibration/air/air.h"
#include "calibration/camera_file/join.h"
#include "calibration/camera_file/level.h"
#include "calibration/camera_file/profile.h"
#include "calibration/optics/edges.h"
#include "calibration/sensor/noise.h"
#include "calibration/sensor/shutter.h"
#include "camera/horizon/horizon.h"
#include "camera/lens/calibration_file.h"
#include "camera/motion/estimator.h"
#include "camera/motion/motion.h"
#include "foundation/base/error.h"
#include "foundation/base/median.h"
#include "picture/video/reader.h"
#include "picture/video/still.h"
#include "scene/scene/limits.h"

namespace airtruth::camera_file {
namespace {

air::GroundRange ground_range(const Options& options) {
  if (options.lens && options.altitude_m) return {options.altitude_m, ""};
  const std::string lens = "the lens (--lens)";
  const std::string altitude =
      "the camera's height above the ground (--altitude; in a scene, position_ned_m)";
  const std::string missing = options.lens         ? altitude
                              : options.altitude_m ? lens
                                                   : lens + " and " + altitude;
  return {std::nullopt, "the ground has no range without " + missing};
}

// Number of frames, spread over the clip, at which noise, edges, horizon and air are measured:
// chosen to bound the time.
constexpr std::int64_t kSampledFrames = 40;
// A shorter clip has fewer than four pairs of frames for noise and edges.
constexpr std::int64_t kMinFrames = 8;
// Field of view that is assumed for finding the horizon when no lens is given.
constexpr double kAssumedFovDeg = 60;

// The visibility beyond which the international visibility code calls the air exceptionally clear
// (extinction.h).
constexpr double kClearKm = air::kVisibilityClassesKm.back();

// The extinction of a clip. One that is measured is stated as it is. One that is not measured is
// not applied: air that may be clear is rendered clear. Its value is then 0, with the extinction of
// exceptionally clear air as the error; or, where the horizon looks hazy, a prior from the
// visibility that its look supports, with an error of the same size. A note says so.
// `height_known`: the height above the ground was given and not assumed.
Quantity extinction_quantity(const air::Air& air, bool height_known) {
  Quantity quantity;
  if (air.extinction_per_km) {
    put(quantity, air.extinction_per_km);
    return quantity;
  }
  const bool is_hazy = air.visibility_km && *air.visibility_km < kClearKm;
  const double per_km = air::kKoschmieder / (is_hazy ? *air.visibility_km : kClearKm);
  quantity.values.assign(3, {is_hazy ? per_km : 0, per_km});
  quantity.source = is_hazy ? "a prior" : "assumed";
  std::string stands = ", and drawn as clear air";
  if (is_hazy)
    stands =
        fmt::format("; a prior by the horizon's look, which is that of {} km of visibility or less",
                    *air.visibility_km);
  if (is_hazy && !height_known)
    stands += fmt::format(" from {} m above the ground", air::kAssumedHeightM);
  if (!is_hazy && air.visibility_km) stands += ", as the horizon looks";
  quantity.note = fmt::format("not measured{}: {}", stands, air.extinction_per_km.why());
  return quantity;
}

class Session {
 public:
  Session(const fs::path& video, const Options& options)
      : options_(options),
        // A single decoder thread: with several, the decoder exports the quantisers of a frame
        // while another thread still fills them in, and the codec's step changes from run to run.
        reader_(video,
                {.picture_rate_hz = options.picture_rate_hz,
                 .threads = 1,
                 .with_quantiser = true,
                 .with_cuts = true},
                options.warn),
        noise_(options.own_aircraft, options.tone),
        edges_(options.own_aircraft, options.tone),
        blur_(options.own_aircraft),
        planar_(reader_.info().width, reader_.info().height, options.own_aircraft) {
    const video::StreamInfo& info = reader_.info();
    video::expect_rate(video, info, options.picture_rate_hz);
    result_.video = video;
    result_.width = info.width;
    result_.height = info.height;
    result_.frame_rate_hz = info.frame_rate.value();
    result_.tone = options.tone;
    if (options.lens) {
      result_.lens = lens_words(*options.lens);
      turning_.emplace(*options.lens, motion::Options{}, options.own_aircraft);
    }
    total_ = std::max<std::int64_t>(0, info.frame_count_estimate);
    every_ = std::max<std::int64_t>(2, total_ / kSampledFrames);
  }

  Calibration run() {
    read_all();
    if (result_.frames < kMinFrames)
      warn(options_.warn,
           fmt::format("{}: holds {} frames; most values take {}",
                       result_.video.string(),
                       result_.frames,
                       kMinFrames));
    if (!result_.cuts.empty())
      warn(options_.warn,
           fmt::format("{}: the clip is cut at frame {}; nothing is measured across",
                       result_.video.string(),
                       fmt::join(result_.cuts, ", ")));
    take_noise();
    take_codec();
    take_edges();
    take_shutter();
    take_sky();
    return std::move(result_);
  }

 private:
  void read_all() {
    std::optional<image::Picture> before;
    while (auto frame = reader_.next()) {
      stop_if_asked();
      const motion::FrameMotion moved =
          planar_.next(frame->picture, frame->time_s, frame->damaged, frame->begins_shot);
      // A frame into which most corners can be tracked does not begin a shot.
      if (frame->begins_shot && !is_known(moved.state)) cut(frame->index, before);
      const std::optional<Homography> step = step_of(moved);
      steps_.back().push_back(step);
      blur_.add(frame->picture, step ? std::optional(centre_motion(*step)) : std::nullopt);
      const std::optional<Quaternion> turned = turn_of(*frame);
      if (frame->quantiser) quantisers_.push_back(*frame->quantiser);
      if (frame->damaged) before.reset();
      if (frame->index % every_ == 1 && before) sample(*before, *frame, step, turned);
      // The measurements of the next sampled frame also use the frame before it.
      if (!frame->damaged) before = std::move(frame->picture);
      ++result_.frames;
      if (options_.progress) options_.progress(result_.frames, total_);
    }
  }

  void stop_if_asked() const {
    if (options_.stop.stop_requested()) throw Interrupted();
  }

  // The homography from the frame before; empty if either of the two was not measured.
  std::optional<Homography> step_of(const motion::FrameMotion& moved) {
    std::optional<Homography> step;
    if (moved.state == motion::State::kMeasured && frame_before_)
      step = moved.frame_from_reference * frame_before_->inverse();
    frame_before_ =
        is_known(moved.state) ? std::optional(moved.frame_from_reference) : std::nullopt;
    return step;
  }

  Pixel centre_motion(const Homography& step) const {
    const Pixel centre(result_.width / 2.0, result_.height / 2.0);
    return apply(step, centre) - centre;
  }

  // Follows the rotation of the camera, if the lens is given. Returns the rotation since the first
  // frame of the clip; empty if it was not measured, or a cut lies between.
  std::optional<Quaternion> turn_of(const video::Frame& frame) {
    if (!turning_) return std::nullopt;
    const motion::FrameMotion turned =
        turning_->next(frame.picture, frame.time_s, frame.damaged, frame.begins_shot);
    cam_from_first_.push_back(*turned.rotation);
    const bool known = is_known(turned.state) && result_.cuts.empty();
    return known ? turned.rotation : std::nullopt;
  }

  void sample(const image::Picture& before,
              const video::Frame& frame,
              const std::optional<Homography>& step,
              const std::optional<Quaternion>& cam_from_first) {
    noise_.add(before, frame.picture);
    edges_.add(frame.picture, step);
    if (static_cast<std::int64_t>(sampled_.size()) < 2 * kSampledFrames)
      sampled_.push_back({frame.picture.clone(), frame.index, cam_from_first});
  }

  // Begins a new shot. No pair of frames and no motion crosses a cut, and the attitude of the
  // camera after the cut relative to the one before it is not known.
  void cut(std::int64_t frame, std::optional<image::Picture>& before) {
    result_.cuts.push_back(frame);
    before.reset();
    blur_.cut();
    steps_.emplace_back();
  }

  Quantities& quantities() { return result_.quantities; }

  void take_noise() {
    result_.noise = noise_.points();
    const auto found = noise_.result();
    put(quantities().noise_gain, found, &sensor::NoiseMeter::Result::gain);
    put(quantities().noise_floor, found, &sensor::NoiseMeter::Result::floor);
    put(quantities().noise_correlation, found, &sensor::NoiseMeter::Result::correlation_px);
  }

  // Measures the step of the H.264 quantiser, which doubles when the quantisation parameter rises
  // by 6 (ITU-T H.264, 8.5.9).
  void take_codec() {
    if (quantisers_.empty()) {
      quantities().codec_step.missing =
          "the decoder of '" + reader_.info().codec + "' does not report its quantiser";
      return;
    }
    std::vector<double> steps;
    for (const double q : quantisers_) steps.push_back(0.625 * std::pow(2.0, q / 6));
    quantities().codec_step.values = {{median(steps), half_spread(steps)}};
  }

  void take_edges() {
    const Quantity& step = quantities().codec_step;
    const double codec_step = step.is_measured() ? step.value().value : 0;  // 0: not known
    const auto found = edges_.result(codec_step);
    put(quantities().point_spread, found, &optics::StepResponse::point_spread_px);
    put(quantities().sharpening, found, &optics::StepResponse::sharpening);
    put(quantities().sharpening_radius, found, &optics::StepResponse::sharpening_px);
    if (!found) {
      quantities().vertical_spread.missing = found.why();
      quantities().chroma_spread.missing = found.why();
      return;
    }
    result_.edge = edges_.profile();
    quantities().point_spread.note =
        fmt::format("across an edge {:.2f} px from 10 to 90 %, by {} edges",
                    result_.edge.spread_px,
                    result_.edge.edges);
    put(quantities().vertical_spread, found->vertical_spread_px);
    put(quantities().chroma_spread, edges_.chroma(*found, codec_step));
  }

  // A share of the frame interval as a time.
  Measured<Estimate> in_seconds(const Measured<Estimate>& share) const {
    if (!share) return share;
    if (!(result_.frame_rate_hz > 0)) return NotMeasured{"the video has no frame rate"};
    const double interval_s = 1 / result_.frame_rate_hz;
    return Estimate{share->value * interval_s, share->sigma * interval_s};
  }

  void take_shutter() {
    put(quantities().exposure, in_seconds(blur_.share()));
    const auto downwards_s =
        in_seconds(sensor::readout_share(steps_, result_.width, result_.height));
    if (!downwards_s) {
      quantities().readout.missing = downwards_s.why();
      return;
    }
    result_.downwards_s = *downwards_s;
    const bool is_rolling = rolls(*downwards_s);
    quantities().readout.values = {
        {is_rolling ? std::abs(downwards_s->value) : 0, downwards_s->sigma}};
    result_.readout_direction = is_rolling && downwards_s->value < 0 ? "up" : "down";
  }

  void take_sky() {
    const lens::ImageSize size{result_.width, result_.height};
    const lens::Lens lens = options_.lens.value_or(lens::pinhole_from_vertical_fov(
        kAssumedFovDeg, size, reader_.info().sample_aspect.value()));
    const horizon::HorizonFinder finder(lens, options_.own_aircraft);
    const Horizons horizons = accepted_horizons(finder, sampled_, [this] { stop_if_asked(); });
    take_horizons(horizons);
    result_.sky_picture = tinted_sky(lens, sampled_, horizons.found);
    air::AirMeter air(lens, options_.own_aircraft, ground_range(options_), options_.tone);
    // Of the horizon that is seen: the air's measure finds the true one (air/ground_track.h), and
    // the sun's error is ten times the dip.
    const auto first_from_level = level_attitude(sampled_, horizons.found, options_.heading_deg, 0);
    for (std::size_t i = 0; i < sampled_.size(); ++i) {
      const auto& [picture, frame, cam_from_first] = sampled_[i];
      // With a known rotation, the attitude of the frame follows from the common one; otherwise the
      // frame has the attitude of its own horizon.
      if (first_from_level && cam_from_first)
        air.add(picture, *cam_from_first * *first_from_level);
      else if (!options_.lens && horizons.found[i])
        air.add(picture, horizon::cam_from_level(horizons.found[i]->up_in_cam));
    }
    const air::Air measured = air.air(options_.stop);
    put(quantities().airlight, measured.airlight);
    quantities().extinction =
        extinction_quantity(measured, options_.altitude_m.has_value() && options_.lens.has_value());
    take_sun(air, first_from_level.has_value());
    if (first_from_level) take_yaw(*first_from_level);
  }

  void take_horizons(const Horizons& horizons) {
    result_.no_horizon = horizons.why_none;
    result_.horizon_note = horizons.note;
    for (std::size_t i = 0; i < sampled_.size(); ++i) {
      const FoundHorizon& found = horizons.found[i];
      if (!found) continue;
      const YawPitchRoll attitude = horizon::attitude_from_up(found->up_in_cam);
      result_.horizons.push_back({sampled_[i].frame, attitude.pitch_deg, attitude.roll_deg});
    }
  }

  void take_yaw(const Quaternion& first_from_world) {
    const auto heading_deg = [&](const Quaternion& cam_from_first) {
      const Quaternion world_from_cam = (cam_from_first * first_from_world).conjugate();
      return yaw_pitch_roll(world_from_cam * cam_from_body()).yaw_deg;
    };
    for (const Quaternion& cam_from_first : cam_from_first_) {
      // The heading is not known after a cut.
      if (!result_.cuts.empty() &&
          static_cast<std::int64_t>(result_.yaw_from_first_deg.size()) >= result_.cuts.front())
        break;
      result_.yaw_from_first_deg.push_back(
          std::remainder(heading_deg(cam_from_first) - heading_deg(cam_from_first_.front()), 360));
    }
  }

  void take_sun(const air::AirMeter& air, bool level_known) {
    const auto sun = [&]() -> Measured<air::Sun> {
      if (!options_.lens) return NotMeasured{"the lens is not known (--lens)"};
      if (!level_known) return NotMeasured{"no horizon is seen that says where level is"};
      return air.sun();
    }();
    put(quantities().sun_azimuth, sun, &air::Sun::azimuth_deg);
    put(quantities().sun_elevation, sun, &air::Sun::elevation_deg);
  }

  Options options_;
  video::Reader reader_;
  Calibration result_;
  sensor::NoiseMeter noise_;
  optics::EdgeMeter edges_;
  sensor::BlurMeter blur_;
  motion::Estimator planar_;
  std::optional<motion::Estimator> turning_;
  // Of the frame before, its motion from the reference; empty if that was not measured.
  std::optional<Homography> frame_before_;
  // One entry per shot.
  std::vector<sensor::Steps> steps_ = std::vector<sensor::Steps>(1);
  std::vector<double> quantisers_;
  // One rotation per frame; empty without a lens.
  std::vector<Quaternion> cam_from_first_;
  std::vector<SampledFrame> sampled_;
  std::int64_t total_ = 0;
  std::int64_t every_ = 2;
};

// The named profile, else that of the camera that the file tells of, else what cameras have.
CameraProfile profile_of(const std::string& name, const video::StreamInfo& info) {
  if (!name.empty()) return camera_profile(name);
  const CameraProfile* known = recognised_profile(info.width, info.height, info.tags);
  return known != nullptr ? *known : usual_camera();
}

void check_ranges(const CalibrateOptions& options) {
  if (options.altitude_m && !(*options.altitude_m > 0 && std::isfinite(*options.altitude_m)))
    throw Error(
        fmt::format("the altitude is {} m; expected a number above 0", *options.altitude_m));
  if (!scene::kTurn.holds(options.heading_deg))
    throw Error(
        fmt::format("the heading is {}; expected {}", options.heading_deg, scene::kTurn.expected));
  if (options.gamma != 0 && !scene::kGamma.holds(options.gamma))
    throw Error(fmt::format("the gamma is {}; expected {}, or 0 for sRGB's curve",
                            options.gamma,
                            scene::kGamma.expected));
}

}  // namespace

Calibration calibrate(const fs::path& video, const Options& options) {
  return Session(video, options).run();
}

Calibration calibrate_camera(const std::vector<fs::path>& clips, const CalibrateOptions& options) {
  check_ranges(options);
  if (clips.empty()) throw Error("there is no clip; expected one video or more");
  if (!options.profile.empty()) camera_profile(options.profile);  // its name is known
  check_joinable(clips);
  const video::StreamInfo info = video::Reader(clips[0], {.threads = 1}).info();
  const CameraProfile profile = profile_of(options.profile, info);
  check_size(profile, info.width, info.height);
  std::optional<image::Mask> mask;
  if (!options.mask.empty()) mask = video::read_mask(options.mask, info.width, info.height);
  Options how;
  if (!options.lens.empty())
    how.lens = lens::read_calibration(options.lens, {info.width, info.height}, options.warn);
  how.own_aircraft = mask ? &*mask : nullptr;
  how.altitude_m = options.altitude_m;
  how.heading_deg = options.heading_deg;
  how.picture_rate_hz = options.frame_rate_hz;
  how.tone.gamma = options.gamma;
  how.warn = options.warn;
  how.stop = options.stop;
  how.progress = options.progress;
  std::vector<Calibration> measured;
  for (const fs::path& clip : clips) measured.push_back(calibrate(clip, how));
  return with_profile(joined(std::move(measured)), profile);
}

}  // namespace airtruth::camera_file
