// SPDX-License-Identifier: Apache-2.0
#include "comparison/match/pose.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include <opencv2/imgproc.hpp>

#include "aircraft/fleet/fleet.h"
#include "aircraft/model/mesh.h"
#include "foundation/base/error.h"
#include "foundation/base/text.h"
#include "labels/projection/exact_box.h"
#include "picture/render/renderer.h"

namespace airtruth::match {
namespace {

// Where a constant of this file states no origin, it is a choice.

constexpr int kViewPx = 128;         // of a rendered view
constexpr double kLengthPx = 80;     // of the aircraft's largest extent in it
constexpr double kSpreadPx = 0.8;    // of the camera, in pixels of the real one's picture
constexpr double kMinCover = 0.2;    // of a pixel that stands out: 8 of 40 code values
constexpr double kGrowthPx = 1.0;    // that spread and threshold add to both sides of a silhouette
constexpr double kMaxRollDeg = 60;   // of the aircraft's up in the picture
constexpr double kAnyRollDeg = -45;  // of the eye's elevation, below which it may be turned anyhow
constexpr double kUprightDeg = 90;   // turn at which a fit counts exp(-1/2)
constexpr double kAspectWeight = 0.5;  // of the logarithm of the aspects' ratio
// The grid of eye places that is searched first: elevations, and steps of azimuth and of turn.
constexpr std::array kElevationsDeg = {0.0, -12.0, -25.0, -42.0, -62.0, -88.0};
constexpr double kAzimuthStepDeg = 15;
constexpr double kTurnStepDeg = 12;
constexpr std::size_t kClosedIn = 4;       // best of the grid that are closed in on
constexpr std::size_t kTypesClosedIn = 3;  // best types that are closed in on
constexpr std::size_t kPosesOfAType = 2;   // that are handed out
constexpr double kUnlikeDeg = 30;          // between two attitudes of one type
constexpr double kNearBest = 0.95;         // of the best fit's score: what is handed out beside it

// Where the eye is, seen from the aircraft (azimuth from its nose towards its right wing, elevation
// above it), and how far the picture is turned about its middle, clockwise.
struct EyePlace {
  double azimuth_deg = 0, elevation_deg = 0, turn_deg = 0;
};

Quaternion cam_from_aircraft(const EyePlace& eye) {
  const Quaternion world_from_eye = world_from_body({eye.azimuth_deg + 180, -eye.elevation_deg, 0});
  const Quaternion upright = cam_from_body() * world_from_eye.conjugate();
  const Quaternion turn(Eigen::AngleAxisd(radians(eye.turn_deg), Vector3::UnitZ()));
  return turn * upright;
}

YawPitchRoll attitude_of(const EyePlace& eye) {
  return yaw_pitch_roll(cam_from_body().conjugate() * cam_from_aircraft(eye));
}

// Coverage of the aircraft, kViewPx square, from far off.
class Views {
 public:
  explicit Views(const model::Mesh& mesh)
      : model_(mesh),
        silhouette_{&mesh, model::silhouette_points(mesh)},
        extents_(model::extents(mesh)) {}

  cv::Mat coverage(double azimuth_deg, double elevation_deg) const {
    const double largest_m =
        std::max({extents_.length_m(), extents_.span_m(), extents_.height_m()});
    const double range_m = 100 * largest_m;
    const double focal_px = kLengthPx * range_m / largest_m;
    const lens::Lens lens = lens::undistorted(false, focal_px, {kViewPx, kViewPx});
    const Quaternion world_from_cam =
        cam_from_aircraft({azimuth_deg, elevation_deg, 0}).conjugate();
    const Vector3 centre = 0.5 * (extents_.low_in_body + extents_.high_in_body);
    const Rigid pose{world_from_cam, centre - range_m * (world_from_cam * Vector3::UnitZ())};
    const projection::Sight sight{&lens, pose.inverse(), Homography::Identity()};
    const auto box = projection::exact_box(sight, silhouette_, {}, 0).box;
    const render::View view{&lens, pose, Homography::Identity(), kViewPx, kViewPx};
    const image::Layer layer = render::render(view, {}, {{&model_, {}, 0}}, {box}, {.quality = 1});
    cv::Mat result(kViewPx, kViewPx, CV_32F, cv::Scalar(0));
    if (layer.empty()) return result;
    for (int y = layer.patch.y; y < layer.patch.bottom(); ++y)
      for (int x = layer.patch.x; x < layer.patch.right(); ++x)
        result.at<float>(y, x) = layer.pixels[layer.index(x, y)].alpha;
    return result;
  }

 private:
  shade::Model model_;
  projection::SilhouettePoints silhouette_;
  model::Extents extents_;
};

// A view turned in its picture.
cv::Mat turned(const cv::Mat& coverage, double turn_deg) {
  const double c = std::cos(radians(turn_deg)), s = std::sin(radians(turn_deg));
  const double middle = (kViewPx - 1) / 2.0;
  const cv::Matx23d map(
      c, -s, middle - c * middle + s * middle, s, c, middle - s * middle - c * middle);
  cv::Mat result;
  cv::warpAffine(coverage, result, map, coverage.size(), cv::INTER_LINEAR);
  return result;
}

// What stands out of a view where its larger side is `larger_px`, bounded tightly.
cv::Mat mask_at(const cv::Mat& coverage, int larger_px) {
  const cv::Mat covered = coverage > 0.5;
  const cv::Rect bounds = cv::boundingRect(covered);
  if (bounds.empty()) return {};
  const double scale = std::max(2.0, larger_px - kGrowthPx) / std::max(bounds.width, bounds.height);
  // Border in pixels, into which the spread reaches with more than 3 standard deviations.
  constexpr int kMargin = 3;
  cv::Mat small, wide;
  cv::resize(coverage(bounds),
             small,
             {std::max(1, static_cast<int>(std::lround(bounds.width * scale))),
              std::max(1, static_cast<int>(std::lround(bounds.height * scale)))},
             0,
             0,
             cv::INTER_AREA);
  cv::copyMakeBorder(small, wide, kMargin, kMargin, kMargin, kMargin, cv::BORDER_CONSTANT, 0);
  cv::GaussianBlur(wide, wide, {}, kSpreadPx, 0, cv::BORDER_CONSTANT);
  const cv::Mat mask = wide > kMinCover;
  const cv::Rect inside = cv::boundingRect(mask);
  if (inside.empty()) return {};
  return mask(inside).clone();
}

// Of two masks whose bounds have one middle.
double overlap_of(const cv::Mat& a, const cv::Mat& b) {
  const int width = std::max(a.cols, b.cols), height = std::max(a.rows, b.rows);
  const auto placed = [&](const cv::Mat& mask) {
    cv::Mat whole(height, width, CV_8UC1, cv::Scalar(0));
    mask.copyTo(
        whole(cv::Rect((width - mask.cols) / 2, (height - mask.rows) / 2, mask.cols, mask.rows)));
    return whole;
  };
  const cv::Mat x = placed(a), y = placed(b);
  return double(cv::countNonZero(x & y)) / std::max(1, cv::countNonZero(x | y));
}

struct Score {
  double total = -1, overlap = 0, aspect_ratio = 1;
};

Score score_of(const std::vector<cv::Mat>& masks, const cv::Mat& coverage) {
  Score score{0, 0, 0};
  for (const cv::Mat& real : masks) {
    const cv::Mat made = mask_at(coverage, std::max(real.cols, real.rows));
    if (made.empty()) return {};
    const double ratio = double(real.cols) / real.rows / (double(made.cols) / made.rows);
    const double overlap = overlap_of(real, made);
    score.overlap += overlap / double(masks.size());
    score.aspect_ratio += ratio / double(masks.size());
    score.total +=
        overlap * std::exp(-kAspectWeight * std::abs(std::log(ratio))) / double(masks.size());
  }
  return score;
}

struct Candidate {
  EyePlace eye;
  Score score;
};

// Aircraft fly upright more often than not: of two that fit alike, the one that is turned less.
double likelihood(const EyePlace& eye) {
  if (eye.elevation_deg <= kAnyRollDeg) return std::exp(-0.5 * 0.25);
  return std::exp(-0.5 * std::pow(eye.turn_deg / kUprightDeg, 2));
}

double total_of(const Candidate& candidate) {
  return candidate.score.total * likelihood(candidate.eye);
}

void keep_better(Candidate& best, const Candidate& other) {
  if (other.score.total >= 0 && total_of(other) > total_of(best)) best = other;
}

bool may_be(const EyePlace& eye) {
  return std::abs(eye.turn_deg) <= kMaxRollDeg || eye.elevation_deg <= kAnyRollDeg;
}

// The best turn of a view.
Candidate best_turn(const std::vector<cv::Mat>& masks, const cv::Mat& coverage, EyePlace eye) {
  Candidate best;
  for (eye.turn_deg = -180; eye.turn_deg < 180; eye.turn_deg += kTurnStepDeg) {
    if (!may_be(eye)) continue;
    keep_better(best, {eye, score_of(masks, turned(coverage, eye.turn_deg))});
  }
  return best;
}

// The best of the grid. An aircraft is its own mirror image: its views from the left are those from
// the right, flipped.
std::vector<Candidate> coarse_fits(const std::vector<cv::Mat>& masks,
                                   const Views& views,
                                   const std::stop_token& stop) {
  std::vector<Candidate> all;
  for (const double elevation_deg : kElevationsDeg)
    for (double azimuth_deg = 0; azimuth_deg <= 180; azimuth_deg += kAzimuthStepDeg) {
      if (stop.stop_requested()) throw Interrupted();
      const cv::Mat right = views.coverage(azimuth_deg, elevation_deg);
      all.push_back(best_turn(masks, right, {azimuth_deg, elevation_deg, 0}));
      if (azimuth_deg == 0 || azimuth_deg == 180) continue;
      cv::Mat left;
      cv::flip(right, left, 1);
      all.push_back(best_turn(masks, left, {-azimuth_deg, elevation_deg, 0}));
    }
  std::ranges::stable_sort(all, std::greater(), total_of);
  all.resize(std::min(all.size(), kClosedIn));
  return all;
}

void close_in(const std::vector<cv::Mat>& masks,
              const Views& views,
              const std::stop_token& stop,
              Candidate& best) {
  for (const double step : {8.0, 4.0, 2.0}) {
    const EyePlace from = best.eye;
    for (const double up : {-step, 0.0, step})
      for (const double round : {-step, 0.0, step}) {
        if (stop.stop_requested()) throw Interrupted();
        EyePlace eye = from;
        eye.elevation_deg = std::clamp(from.elevation_deg + up, -89.0, 0.0);
        eye.azimuth_deg = from.azimuth_deg + round;
        const cv::Mat coverage = views.coverage(eye.azimuth_deg, eye.elevation_deg);
        for (const double turn : {-step, 0.0, step}) {
          eye.turn_deg = from.turn_deg + turn;
          if (!may_be(eye)) continue;
          keep_better(best, {eye, score_of(masks, turned(coverage, eye.turn_deg))});
        }
      }
  }
}

// The coarse ones closed in on, best first.
std::vector<Candidate> closed_in(const std::vector<cv::Mat>& masks,
                                 const Views& views,
                                 const std::vector<Candidate>& coarse,
                                 const std::stop_token& stop) {
  std::vector<Candidate> all = coarse;
  for (Candidate& candidate : all) {
    candidate.score =
        score_of(masks,
                 turned(views.coverage(candidate.eye.azimuth_deg, candidate.eye.elevation_deg),
                        candidate.eye.turn_deg));
    close_in(masks, views, stop, candidate);
  }
  std::ranges::stable_sort(all, std::greater(), total_of);
  return all;
}

bool is_unlike(const PoseFit& fit, const std::vector<PoseFit>& others) {
  return std::none_of(others.begin(), others.end(), [&](const PoseFit& other) {
    return degrees(world_from_body(fit.attitude).angularDistance(world_from_body(other.attitude))) <
           kUnlikeDeg;
  });
}

// A type with the best attitudes of the coarse grid.
struct Contender {
  std::string name;
  fleet::Aircraft aircraft;
  std::vector<Candidate> coarse;
};

// The types whose coarse silhouettes fit best, at most kTypesClosedIn, best first.
std::vector<Contender> contenders_among(const std::vector<std::string>& types,
                                        const cv::Mat& mask,
                                        const Warn& warn_to,
                                        const std::stop_token& stop) {
  model::LoadOptions load;
  load.stop = stop;
  std::vector<Contender> contenders;
  for (const std::string& type : types) {
    try {
      contenders.push_back({type, fleet::load_aircraft(type, load, {}), {}});
    } catch (const Error& error) {
      warn(warn_to, type + " is not compared with the real aircraft: " + error.what());
      continue;
    }
    Contender& last = contenders.back();
    last.coarse = coarse_fits({mask}, Views(last.aircraft.mesh), stop);
  }
  if (contenders.empty()) throw Error("no aircraft can be loaded to compare the real one with");
  std::ranges::stable_sort(
      contenders, std::greater(), [](const Contender& one) { return total_of(one.coarse[0]); });
  contenders.resize(std::min(contenders.size(), kTypesClosedIn));
  return contenders;
}

}  // namespace

std::vector<std::string> types_to_match(bool helicopters) {
  if (helicopters)
    return words_in(
        "helicopter-light/white helicopter-turbine/white helicopter-twin/white "
        "helicopter-tandem/white");
  return words_in(
      "738/738-default 747/744-Default A320/A320-default CR7/CR7-Default AT7/AT7-default "
      "Citation-Bravo/Models/Bravo-ai beech-200/beech-200-vh-mwk SF3/SFF-Airest pa-28/pa-28-g-egll "
      "c172/ei-mcf");
}

std::vector<PoseFit> fit_types(const std::vector<cv::Mat>& masks,
                               const std::vector<std::string>& types,
                               const Warn& warn_to,
                               const std::stop_token& stop) {
  std::vector<std::pair<double, PoseFit>> fits;
  for (const Contender& one : contenders_among(types, masks[0], warn_to, stop)) {
    std::vector<PoseFit> of_type;
    for (const Candidate& fit : closed_in(masks, Views(one.aircraft.mesh), one.coarse, stop)) {
      const PoseFit next{one.name, attitude_of(fit.eye), fit.score.overlap, fit.score.aspect_ratio};
      if (of_type.size() >= kPosesOfAType || !is_unlike(next, of_type)) continue;
      of_type.push_back(next);
      fits.emplace_back(total_of(fit), next);
    }
  }
  std::ranges::stable_sort(fits, std::greater(), &std::pair<double, PoseFit>::first);
  std::vector<PoseFit> result;
  for (const auto& [total, fit] : fits)
    if (total >= kNearBest * fits[0].first) result.push_back(fit);
  return result;
}

}  // namespace airtruth::match
