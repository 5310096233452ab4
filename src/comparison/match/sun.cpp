// SPDX-License-Identifier: Apache-2.0
#include "comparison/match/sun.h"

#include <algorithm>
#include <cmath>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "comparison/appearance/segment.h"
#include "foundation/base/error.h"
#include "foundation/image/colour.h"
#include "foundation/image/mats.h"
#include "sequence/insertion/ambient.h"
#include "sequence/insertion/paint.h"
#include "sequence/setup/moment.h"
#include "sequence/setup/world.h"

namespace airtruth::match {
namespace {

// Where a constant of this file states no origin, it is a choice.

// Point spread of a camera that states none, as in pose.cpp.
constexpr double kUnstatedSpreadPx = 0.8;
// Elevation of the lowest sun that is tried.
constexpr double kLowestSunDeg = 10;
constexpr std::size_t kSunsClosedIn = 3;  // best of the coarse ones that are closed in on

struct Sun {
  double azimuth_deg = 0, elevation_deg = 0;
};

// From 10 degrees above the horizon upwards, about `spacing_deg` from one to the next.
std::vector<Sun> suns(double spacing_deg) {
  std::vector<Sun> all;
  for (double elevation_deg = kLowestSunDeg; elevation_deg < 85;
       elevation_deg += spacing_deg * 2 / 3)
    for (double azimuth_deg = 0; azimuth_deg < 360; azimuth_deg += spacing_deg)
      all.push_back({azimuth_deg, elevation_deg});
  all.push_back({0, 90});
  return all;
}

// The four neighbours of a sun on the sky, above the horizon.
std::vector<Sun> suns_near(const SunFit& fit, double step_deg) {
  const double level = std::max(0.2, std::cos(radians(fit.elevation_deg)));
  const double turn_deg = step_deg / level;
  const auto at = [](double azimuth_deg, double elevation_deg) {
    return Sun{std::fmod(azimuth_deg + 360, 360), std::clamp(elevation_deg, 3.0, 90.0)};
  };
  return {at(fit.azimuth_deg - turn_deg, fit.elevation_deg),
          at(fit.azimuth_deg + turn_deg, fit.elevation_deg),
          at(fit.azimuth_deg, fit.elevation_deg - step_deg),
          at(fit.azimuth_deg, fit.elevation_deg + step_deg)};
}

bool is_better(const SunFit& a, const SunFit& b) { return a.difference_codes < b.difference_codes; }

constexpr double kBlurShare = 0.08;  // of the box's larger side: poses fit no better than that

// What an aircraft adds to its surroundings, float RGB code values, in a box with a quarter around
// it, brought to a size. Empty where that leaves the picture.
cv::Mat contrast_in(const image::Picture& picture, const Box& box, const cv::Size& size) {
  const double margin = std::max(2.0, std::max(box.width, box.height) / 4);
  const PixelBox area = pixels_of(wider(box, margin));
  if (area.x < 0 || area.y < 0 || area.right() > picture.width || area.bottom() > picture.height)
    return {};
  const image::Rgb8 crop = image::rgb8_from_picture(picture, area);
  cv::Mat colour;
  image::mat_of(crop).convertTo(colour, CV_32FC3);
  cv::Mat rim(colour.size(), CV_8UC1, cv::Scalar(0));
  cv::rectangle(rim, cv::Rect(0, 0, rim.cols, rim.rows), cv::Scalar(255));
  std::vector<cv::Mat> channels;
  cv::split(colour, channels);
  for (cv::Mat& channel : channels) channel -= appearance::surroundings_of(channel, rim);
  cv::merge(channels, colour);
  if (!size.empty() && colour.size() != size)
    cv::resize(colour, colour, size, 0, 0, cv::INTER_LINEAR);
  return colour;
}

cv::Mat blurred(const cv::Mat& picture) {
  cv::Mat result;
  cv::GaussianBlur(
      picture, result, {}, std::max(0.5, kBlurShare * std::max(picture.cols, picture.rows)));
  return result;
}

// The sum of squares of the differences of two pictures' values, channel by channel, each sorted:
// no place counts, only how much of the picture is how bright.
double sorted_squares(const cv::Mat& a, const cv::Mat& b) {
  std::vector<cv::Mat> of_a, of_b;
  cv::split(a, of_a), cv::split(b, of_b);
  double sum = 0;
  for (std::size_t c = 0; c < of_a.size(); ++c) {
    cv::Mat in_a, in_b;
    cv::sort(of_a[c].reshape(1, 1), in_a, cv::SORT_EVERY_ROW);
    cv::sort(of_b[c].reshape(1, 1), in_b, cv::SORT_EVERY_ROW);
    sum += std::pow(cv::norm(in_a, in_b), 2);
  }
  return sum;
}

// Sums over samples of both aircraft.
struct Agreement {
  double squares = 0, real_squares = 0, made_squares = 0, products = 0, samples = 0;

  void add(const cv::Mat& real, const cv::Mat& made) {
    const cv::Mat a = blurred(real), b = blurred(made);
    squares += (std::pow(cv::norm(a, b), 2) + sorted_squares(real, made)) / 2;
    real_squares += a.dot(a), made_squares += b.dot(b), products += a.dot(b);
    samples += 3 * static_cast<double>(real.total());
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
        world_(setup::load_world(
            scene, {frames[0].picture->width, frames[0].picture->height}, {}, stop)) {
    for (const SunFrame& frame : frames) {
      View view{frame.picture,
                setup::moment_at(world_, 0, frame.time_s, {}),
                contrast_in(*frame.picture, frame.real, {})};
      if (view.moment.boxes[0].box && !view.real.empty()) views_.push_back(std::move(view));
    }
  }

  Agreement under(const Sun& sun, const std::stop_token& stop) {
    scene_.light.sun_azimuth_deg = sun.azimuth_deg;
    scene_.light.sun_elevation_deg = sun.elevation_deg;
    Agreement agreement;
    for (const View& view : views_) {
      if (stop.stop_requested()) throw Interrupted();
      insertion::AmbientEstimator light(scene_.light, scene_.camera_model, nullptr);
      image::Picture painted = view.picture->clone();
      insertion::Painter(scene_, world_, insertion::Occluders())
          .paint(painted, view.moment, light.next(painted, view.moment.sight, {}));
      const auto made = appearance::seen_in(painted, *view.moment.boxes[0].box);
      if (!made) continue;
      const cv::Mat contrast = contrast_in(painted, made->box, view.real.size());
      if (!contrast.empty()) agreement.add(view.real, contrast);
    }
    return agreement;
  }

 private:
  // What is the same under every sun.
  struct View {
    const image::Picture* picture = nullptr;
    setup::Moment moment;
    cv::Mat real;  // what the real aircraft adds to its surroundings
  };

  scene::Scene scene_;
  setup::World world_;
  std::vector<View> views_;
};

scene::Scene prepared(scene::Scene scene) {
  scene.camera_model.automatic.clear();
  scene.camera_model.codec_step.reset();
  scene.realism = {};
  scene.render.quality = 1;
  if (!scene.camera_model.point_spread_px) scene.camera_model.point_spread_px = kUnstatedSpreadPx;
  return scene;
}

}  // namespace

std::optional<SunFit> fit_sun(const scene::Scene& scene,
                              const std::vector<SunFrame>& frames,
                              double spacing_deg,
                              const std::stop_token& stop) {
  check(!frames.empty(), "a sun is fitted to frames");
  Lit lit(prepared(scene), frames, stop);
  const auto fit_of = [&](const Sun& sun) -> std::optional<SunFit> {
    const Agreement agreement = lit.under(sun, stop);
    if (!(agreement.samples > 0)) return std::nullopt;
    return SunFit{
        sun.azimuth_deg, sun.elevation_deg, agreement.difference(), agreement.correlation()};
  };
  std::vector<SunFit> coarse;
  for (const Sun& sun : suns(spacing_deg))
    if (const auto fit = fit_of(sun)) coarse.push_back(*fit);
  if (coarse.empty()) return std::nullopt;
  std::ranges::stable_sort(coarse, is_better);
  SunFit best = coarse[0];
  for (std::size_t i = 0; i < std::min(kSunsClosedIn, coarse.size()); ++i) {
    SunFit here = coarse[i];
    for (const double step_deg : {spacing_deg / 2, spacing_deg / 4})
      for (const Sun& near : suns_near(here, step_deg))
        if (const auto fit = fit_of(near); fit && is_better(*fit, here)) here = *fit;
    if (is_better(here, best)) best = here;
  }
  return best;
}

}  // namespace airtruth::match
