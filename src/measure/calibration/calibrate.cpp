// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include <fmt/ranges.h>

#include "camera/horizon/horizon.h"
#include "camera/motion/motion.h"
#include "foundation/base/error.h"
#include "foundation/base/median.h"
#include "measure/air/air.h"
#include "measure/calibration/calibration.h"
#include "measure/optics/edges.h"
#include "measure/sensor/blur.h"
#include "measure/sensor/noise.h"
#include "measure/sensor/readout.h"
#include "picture/video/reader.h"

namespace airtruth::calibration {
namespace {

GroundRange ground_range(const Options& options) {
  if (options.lens && options.altitude_m) return {options.altitude_m, ""};
  const std::string lens = "the lens (--lens)";
  const std::string altitude =
      "the camera's height above the ground (--altitude; in a scene, position_ned_m)";
  const std::string missing = options.lens         ? altitude
                              : options.altitude_m ? lens
                                                   : lens + " and " + altitude;
  return {std::nullopt, "the ground has no range without " + missing};
}

constexpr std::int64_t kSampledFrames = 40;
constexpr std::int64_t kFewestFrames = 8;
// Field of view that is assumed for finding the horizon when no lens is given.
constexpr double kAssumedFovDeg = 60;

// A frame that is used for horizon, sky and ground.
struct Sampled {
  image::Picture picture;
  std::int64_t frame = 0;
  Quaternion cam_from_first = Quaternion::Identity();
  bool turn_known = false;
};

bool is_measured(const motion::FrameMotion& motion) {
  return motion.state == motion::State::kMeasured || motion.state == motion::State::kReference;
}

class Session {
 public:
  Session(const fs::path& video, const Options& options)
      : options_(options),
        reader_(video, {options.first_frame, options.frame_count, 0, true, true}, options.warn),
        noise_(options.own_aircraft, options.tone),
        edges_(options.own_aircraft, options.tone),
        blur_(options.own_aircraft),
        planar_(reader_.info().width, reader_.info().height, {}, options.own_aircraft) {
    const video::StreamInfo& info = reader_.info();
    result_.video = video;
    result_.width = info.width;
    result_.height = info.height;
    result_.frame_rate_hz = info.frame_rate.value();
    result_.tone = options.tone;
    if (options.lens) {
      result_.lens = lens_words(*options.lens);
      turning_.emplace(*options.lens, motion::Options{}, options.own_aircraft);
    }
    total_ = options.frame_count.value_or(
        std::max<std::int64_t>(0, info.frame_count_estimate - options.first_frame));
    every_ = std::max<std::int64_t>(2, total_ / kSampledFrames);
  }

  Calibration run() {
    read_all();
    if (result_.frames < kFewestFrames)
      options_.warn ? options_.warn(fmt::format("{}: holds {} frames; most values take {}",
                                                result_.video.string(),
                                                result_.frames,
                                                kFewestFrames))
                    : void();
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
    std::optional<Homography> last;
    while (auto frame = reader_.next()) {
      if (options_.stop.stop_requested()) throw Interrupted();
      const motion::FrameMotion moved =
          planar_.next(frame->picture, frame->time_s, frame->damaged, frame->begins_shot);
      // A frame into which most corners can be tracked does not begin a shot.
      if (frame->begins_shot && !is_measured(moved)) cut(frame->index, before);
      std::optional<Homography> step;
      if (moved.state == motion::State::kMeasured && last)
        step = moved.frame_from_reference * last->inverse();
      last = is_measured(moved) ? std::optional(moved.frame_from_reference) : std::nullopt;
      steps_.back().push_back(step);
      const Pixel centre(result_.width / 2.0, result_.height / 2.0);
      blur_.add(frame->picture,
                step ? std::optional<Pixel>(apply(*step, centre) - centre) : std::nullopt);
      std::optional<motion::FrameMotion> turned;
      if (turning_) {
        turned = turning_->next(frame->picture, frame->time_s, frame->damaged, frame->begins_shot);
        cam_from_first_.push_back(*turned->rotation);
      }
      if (frame->quantiser) quantisers_.push_back(*frame->quantiser);
      if (frame->index % every_ == 1 && before) {
        noise_.add(*before, frame->picture);
        edges_.add(frame->picture, step);
        if (static_cast<std::int64_t>(sampled_.size()) < 2 * kSampledFrames)
          sampled_.push_back({frame->picture.clone(),
                              frame->index,
                              turned ? *turned->rotation : Quaternion::Identity(),
                              turned && is_measured(*turned) && result_.cuts.empty()});
      }
      // The measurements of the next sampled frame also use the frame before it.
      before = std::move(frame->picture);
      ++result_.frames;
      if (options_.progress) options_.progress(result_.frames, total_);
    }
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

  // Stores an answer of a meter.
  static void put(Quantity& quantity, const Measured<Estimate>& measured) {
    if (measured)
      quantity.values = {*measured};
    else
      quantity.missing = measured.why();
  }
  static void put(Quantity& quantity, const Measured<ColourEstimate>& measured) {
    if (measured)
      quantity.values.assign(measured->begin(), measured->end());
    else
      quantity.missing = measured.why();
  }
  // The quantity that is the member `part` of a meter's answer.
  template <typename Whole>
  static void put(Quantity& quantity, const Measured<Whole>& measured, Estimate Whole::*part) {
    put(quantity,
        measured ? Measured<Estimate>((*measured).*part)
                 : Measured<Estimate>(NotMeasured{measured.why()}));
  }

  void take_noise() {
    result_.noise = noise_.points();
    const auto found = noise_.result();
    put(quantities().noise_gain, found, &NoiseMeter::Result::gain);
    put(quantities().noise_floor, found, &NoiseMeter::Result::floor);
    put(quantities().noise_correlation, found, &NoiseMeter::Result::correlation_px);
  }

  // Measures the step of the H.264 quantiser, which doubles when the quantisation parameter rises
  // by 6 (ITU-T H.264, 8.5.9).
  void take_codec() {
    if (quantisers_.empty()) {
      quantities().codec_step.missing =
          "the decoder of '" + reader_.info().codec + "' does not tell its quantiser";
      return;
    }
    std::vector<double> steps;
    for (const double q : quantisers_) steps.push_back(0.625 * std::pow(2.0, q / 6));
    std::sort(steps.begin(), steps.end());
    const std::size_t n = steps.size();
    quantities().codec_step.values = {
        {steps[n / 2], (steps[n * 84 / 100] - steps[n * 16 / 100]) / 2}};
  }

  // 0 if it is not known.
  double codec_step() const {
    const Quantity& step = result_.quantities.codec_step;
    return step.is_measured() ? step.value().value : 0;
  }

  void take_edges() {
    const auto found = edges_.result(codec_step());
    put(quantities().point_spread, found, &StepResponse::point_spread_px);
    put(quantities().sharpening, found, &StepResponse::sharpening);
    put(quantities().sharpening_radius, found, &StepResponse::sharpening_px);
    if (!found) {
      quantities().chroma_spread.missing = found.why();
      return;
    }
    result_.edge = edges_.profile();
    quantities().point_spread.note =
        fmt::format("across an edge {:.2f} px from 10 to 90 %, by {} edges",
                    result_.edge.spread_px,
                    result_.edge.edges);
    put(quantities().chroma_spread, edges_.chroma(*found, codec_step()));
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
    const auto downwards_s = in_seconds(readout_share(steps_, result_.width, result_.height));
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
    const lens::Lens lens =
        options_.lens.value_or(lens::pinhole_from_vertical_fov(kAssumedFovDeg, size));
    const motion::HorizonFinder finder(lens, options_.own_aircraft);
    const auto found = horizons_of(finder);
    // The upward directions in the camera frame of the first frame.
    std::vector<Vector3> ups;
    for (std::size_t i = 0; i < found.size(); ++i) {
      if (!found[i]) continue;
      const YawPitchRoll attitude = motion::attitude_from_up(found[i]->up_in_cam);
      result_.horizons.push_back(
          {sampled_[i].frame, attitude.pitch_deg, attitude.roll_deg, found[i]->separation});
      if (sampled_[i].turn_known)
        ups.push_back(sampled_[i].cam_from_first.conjugate() * found[i]->up_in_cam);
    }
    tint_sky(lens, found);
    AirMeter air(lens, options_.own_aircraft, ground_range(options_), options_.tone);
    const auto first_from_level = levelled(ups);
    for (std::size_t i = 0; i < sampled_.size(); ++i) {
      // With a known rotation, the attitude of the frame follows from the common one; otherwise the
      // frame has the attitude of its own horizon.
      if (first_from_level && sampled_[i].turn_known)
        air.add(sampled_[i].picture, sampled_[i].cam_from_first * *first_from_level);
      else if (!options_.lens && found[i])
        air.add(sampled_[i].picture, motion::cam_from_level(found[i]->up_in_cam));
    }
    const Air measured = air.air(options_.stop);
    put(quantities().airlight, measured.airlight);
    take_extinction(measured);
    take_sun(air, first_from_level.has_value());
    if (first_from_level) take_yaw(*first_from_level);
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

  // cam_from_world of the first frame, from the median of the upward directions.
  std::optional<Quaternion> levelled(const std::vector<Vector3>& ups) const {
    if (ups.empty()) return std::nullopt;
    Vector3 middle;
    for (int axis = 0; axis < 3; ++axis) {
      std::vector<double> values;
      for (const Vector3& up : ups) values.push_back(up[axis]);
      middle[axis] = median(std::move(values));
    }
    const Quaternion cam_from_heading = motion::cam_from_level(middle.normalized());
    const Quaternion heading(Eigen::AngleAxisd(-radians(options_.heading_deg), Vector3::UnitZ()));
    return cam_from_heading * heading;
  }

  void take_extinction(const Air& air) {
    if (air.extinction_per_km) {
      put(quantities().extinction, air.extinction_per_km);
      return;
    }
    // An extinction that is not measured is not applied: air that may be clear is rendered clear.
    // The error is the extinction of a visibility of 50 km (Koschmieder: 3.912 / visibility),
    // beyond which the international visibility code calls the air exceptionally clear. A horizon
    // that appears hazy gives a prior.
    constexpr double kKoschmieder = 3.912, kClearKm = 50;
    if (air.visibility_km && *air.visibility_km < kClearKm) {
      const double per_km = kKoschmieder / *air.visibility_km;
      const Estimate hazy{per_km, per_km};
      quantities().extinction.values = {hazy, hazy, hazy};
      quantities().extinction.note = fmt::format(
          "not measured; a prior by the horizon's look, which is that of {} km of visibility or "
          "less{}: {}",
          *air.visibility_km,
          options_.altitude_m && options_.lens
              ? ""
              : fmt::format(" from {} m above the ground", kAssumedHeightM),
          air.extinction_per_km.why());
      return;
    }
    const Estimate clear{0, kKoschmieder / kClearKm};
    quantities().extinction.values = {clear, clear, clear};
    quantities().extinction.note = fmt::format("not measured, and drawn as clear air{}: {}",
                                               air.visibility_km ? ", as the horizon looks" : "",
                                               air.extinction_per_km.why());
  }

  void take_sun(const AirMeter& air, bool level_known) {
    const auto sun = [&]() -> Measured<Sun> {
      if (!options_.lens) return NotMeasured{"the lens is not known (--lens)"};
      if (!level_known) return NotMeasured{"no horizon is seen that says where level is"};
      return air.sun();
    }();
    put(quantities().sun_azimuth, sun, &Sun::azimuth_deg);
    put(quantities().sun_elevation, sun, &Sun::elevation_deg);
  }

  // The horizons that are accepted. If most frames show a sky whose boundary is not a sharp line,
  // the lines in the other frames are accidental too, and no horizon is accepted.
  std::vector<std::optional<motion::HorizonFinder::Found>> horizons_of(
      const motion::HorizonFinder& finder) {
    std::vector<std::optional<motion::HorizonFinder::Found>> found;
    std::size_t parted = 0, sharp = 0;
    for (const Sampled& sampled : sampled_) {
      if (options_.stop.stop_requested()) throw Interrupted();
      found.push_back(finder.find(sampled.picture));
      if (!found.back()) continue;
      ++(found.back()->is_sharp() ? sharp : parted);
      if (!found.back()->is_sharp()) found.back().reset();
    }
    if (sharp == 0 && parted == 0) {
      result_.no_horizon =
          fmt::format("in none of {} frames do a sky and a ground part", sampled_.size());
    } else if (sharp < parted) {
      result_.no_horizon = fmt::format(
          "a line that is sharp from side to side parts sky and ground in {} of {} frames; in {} "
          "they part without one, as at a coast, hills, haze or clouds: no pitch, roll or sky is "
          "taken from it",
          sharp,
          sampled_.size(),
          parted);
      for (auto& horizon : found) horizon.reset();
    } else if (parted > 0) {
      result_.horizon_note = fmt::format(
          "measured in {} of {} frames; in {} sky and ground part without a line that "
          "is sharp from side to side, and these are left out",
          sharp,
          sampled_.size(),
          parted);
    }
    return found;
  }

  // Keeps the middle one of the sampled frames with a horizon, with its sky tinted.
  void tint_sky(const lens::Lens& lens,
                const std::vector<std::optional<motion::HorizonFinder::Found>>& found) {
    std::vector<std::size_t> with;
    for (std::size_t i = 0; i < found.size(); ++i)
      if (found[i]) with.push_back(i);
    if (with.empty()) return;
    const std::size_t i = with[with.size() / 2];
    image::Rgb8 picture = image::rgb8_from_picture(sampled_[i].picture);
    for (int y = 0; y < picture.height; ++y)
      for (int x = 0; x < picture.width; ++x) {
        const auto ray = lens.ray_from_pixel({x + 0.5, y + 0.5});
        if (!ray || ray->dot(found[i]->up_in_cam) <= 0) continue;
        std::uint8_t* p = picture.at(x, y);
        p[0] = static_cast<std::uint8_t>(p[0] * 3 / 4 + 60);
      }
    result_.sky_picture = std::move(picture);
  }

  Options options_;
  video::Reader reader_;
  Calibration result_;
  NoiseMeter noise_;
  EdgeMeter edges_;
  BlurMeter blur_;
  motion::Estimator planar_;
  std::optional<motion::Estimator> turning_;
  // One entry per shot.
  std::vector<Steps> steps_ = std::vector<Steps>(1);
  std::vector<double> quantisers_;
  // One rotation per frame; empty without a lens.
  std::vector<Quaternion> cam_from_first_;
  std::vector<Sampled> sampled_;
  std::int64_t total_ = 0;
  std::int64_t every_ = 2;
};

}  // namespace

Calibration calibrate(const fs::path& video, const Options& options) {
  return Session(video, options).run();
}

std::string lens_words(const lens::Lens& lens) {
  return fmt::format("{} {:.1f} px", lens.name(), lens.focal_px());
}

}  // namespace airtruth::calibration
