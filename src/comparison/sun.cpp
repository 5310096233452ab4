// SPDX-License-Identifier: Apache-2.0
#include "comparison/sun.h"

#include <array>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "base/error.h"
#include "comparison/segment.h"
#include "sequence/ambient.h"
#include "sequence/paint.h"
#include "sequence/world.h"

namespace airtruth::comparison {
namespace {

constexpr double kUnstatedSpreadPx = 0.8;
constexpr std::array kSunElevationsDeg = {10.0, 25.0, 45.0, 65.0};
constexpr double kSunAzimuthStepDeg = 30;

struct Sun {
  double azimuth_deg = 0, elevation_deg = 0;
};

std::vector<Sun> suns() {
  std::vector<Sun> all;
  for (const double elevation_deg : kSunElevationsDeg)
    for (double azimuth_deg = 0; azimuth_deg < 360; azimuth_deg += kSunAzimuthStepDeg)
      all.push_back({azimuth_deg, elevation_deg});
  all.push_back({0, 90});
  return all;
}

// What an aircraft adds to the luma of its surroundings, in a box with a quarter around it, brought
// to a size. Empty where that leaves the picture.
cv::Mat contrast_in(const image::Picture& picture, const Box& box, const cv::Size& size) {
  const double margin = std::max(2.0, std::max(box.width, box.height) / 4);
  const PixelBox area = pixels_of(
      {box.x - margin, box.y - margin, box.width + 2 * margin, box.height + 2 * margin});
  if (area.x < 0 || area.y < 0 || area.right() > picture.width || area.bottom() > picture.height)
    return {};
  const cv::Mat grey = luma_of(picture, area);
  cv::Mat rim(grey.size(), CV_8UC1, cv::Scalar(0));
  cv::rectangle(rim, cv::Rect(0, 0, grey.cols, grey.rows), cv::Scalar(255));
  cv::Mat contrast = grey - surroundings_of(grey, rim);
  if (!size.empty() && contrast.size() != size)
    cv::resize(contrast, contrast, size, 0, 0, cv::INTER_LINEAR);
  return contrast;
}

// Sums over samples of both aircraft.
struct Agreement {
  double squares = 0, real_squares = 0, made_squares = 0, products = 0, samples = 0;

  void add(const cv::Mat& real, const cv::Mat& made) {
    squares += std::pow(cv::norm(real, made), 2);
    real_squares += real.dot(real), made_squares += made.dot(made), products += real.dot(made);
    samples += static_cast<double>(real.total());
  }
  double difference() const { return std::sqrt(squares / samples); }
  double correlation() const {
    const double both = std::sqrt(real_squares * made_squares);
    return both > 0 ? products / both : 0;
  }
};

class Lit {
 public:
  Lit(const scene::Scene& scene, const std::vector<SunFrame>& frames, const std::stop_token& stop)
      : scene_(scene),
        world_(sequence::load_world(
            scene, {frames[0].picture->width, frames[0].picture->height}, {}, stop)) {}

  void add(const SunFrame& frame, const Sun& sun, Agreement& agreement) {
    scene_.light.sun_azimuth_deg = sun.azimuth_deg;
    scene_.light.sun_elevation_deg = sun.elevation_deg;
    const sequence::Moment moment = sequence::moment_at(world_, 0, frame.time_s, {});
    if (!moment.boxes[0].box) return;
    sequence::AmbientEstimator light(
        scene_.light, sequence::tone_of(scene_.camera_model), nullptr);
    image::Picture painted = frame.picture->clone();
    sequence::make_painter(scene_, world_, nullptr, {})
        ->paint(painted, moment, light.next(painted, moment.sight, {}));
    const cv::Mat real = contrast_in(*frame.picture, frame.real, {});
    const auto made = seen_in(painted, *moment.boxes[0].box);
    if (real.empty() || !made) return;
    const cv::Mat contrast = contrast_in(painted, made->box, real.size());
    if (!contrast.empty()) agreement.add(real, contrast);
  }

 private:
  scene::Scene scene_;
  sequence::World world_;
};

scene::Scene prepared(scene::Scene scene) {
  scene.camera_model.automatic.clear();
  scene.realism = {};
  if (!scene.camera_model.point_spread_px) scene.camera_model.point_spread_px = kUnstatedSpreadPx;
  return scene;
}

}  // namespace

std::optional<SunFit> fit_sun(const scene::Scene& scene,
                              const std::vector<SunFrame>& frames,
                              const std::stop_token& stop) {
  check(!frames.empty(), "a sun is fitted to frames");
  Lit lit(prepared(scene), frames, stop);
  std::optional<SunFit> best;
  for (const Sun& sun : suns()) {
    Agreement agreement;
    for (const SunFrame& frame : frames) {
      if (stop.stop_requested()) throw Interrupted();
      lit.add(frame, sun, agreement);
    }
    if (!(agreement.samples > 0)) continue;
    const SunFit fit{
        sun.azimuth_deg, sun.elevation_deg, agreement.difference(), agreement.correlation()};
    if (!best || fit.difference_codes < best->difference_codes) best = fit;
  }
  return best;
}

}  // namespace airtruth::comparison
