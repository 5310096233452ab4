// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "camera/opencv_plugin/opencv_plugin.h"
#include "foundation/base/error.h"
#include "foundation/base/median.h"
#include "foundation/base/seed.h"
#include "foundation/image/mats.h"
#include "runners/tracking/classifier.h"
#include "runners/tracking/luma_window.h"
#include "runners/tracking/tracker.h"

// AM3, re-implemented from the public record: adaptive tracking by multiple-instance learning with
// weighted instances, several classifiers that vote and several resolutions (Fu et al., "Real-time
// Adaptive Multi-Classifier Multi-Resolution Visual Tracking Framework for Unmanned Aerial
// Vehicles", RED-UAS 2013, abstract; the tracker of the E-Vision paper's section IV). Its authors'
// code is not public. Details that the record leaves open are chosen here and marked, and this
// implementation does not claim to reproduce their numbers.
//
// A classifier is a sum of Gaussian log-ratios of Haar-like box sums (Babenko, Yang and Belongie
// 2011, "Robust object tracking with online multiple instance learning", eq. 5 to 8). With
// `weighted` it learns as in Zhang and Song 2013, "Real-time visual tracking via online weighted
// multiple instance learning", eq. 8 to 14: instances of the positive bag have the weight
// exp(-distance), and weak classifiers are chosen by the first-order expansion of the bag
// likelihood. Without `weighted` it chooses greedily by Babenko's noisy-OR.
//
// The following choices are this implementation's own; docs/evaluation.md has their measured
// effect: how levels and voters are combined; that the windows elsewhere with the highest scores
// are learned as negatives (`hard`); that the positive bag shrinks with the object.
namespace airtruth::tracking {
namespace {

// The record leaves these constants open: they are choices.

// Smallest side of the object at the coarsest level, in that level's pixels.
constexpr int kMinSidePx = 6;
// A smaller object is tracked with some of its surroundings.
constexpr int kMinWindowPx = 8;
constexpr int kMinTemplatePx = 5;          // Haar features of two boxes fit
constexpr std::size_t kMinSurvivors = 12;  // candidates of a level, however few it has
// Share of a level's candidates that the next level evaluates.
constexpr double kSurvivors = 0.02;
// Windows with high scores that share more than this with the object count as the object.
constexpr double kHardOverlap = 0.1;
// Distance between two such windows, in pixels of a level.
constexpr double kHardApartPx = 2;
// Number of best candidates among which they are searched.
constexpr std::size_t kHardLooked = 400;
// Change of scale after which the classifiers start anew.
constexpr double kAnew = 1.5;
// The scale does not shrink the object below this width.
constexpr double kMinObjectPx = 3;

struct Candidate {
  Place place;
  float vote = 0;
  float score = 0;  // of the level's voters
};

bool better(const Candidate& a, const Candidate& b) {
  if (a.vote != b.vote) return a.vote > b.vote;
  if (a.score != b.score) return a.score > b.score;
  return a.place.y != b.place.y ? a.place.y < b.place.y : a.place.x < b.place.x;
}

// Best first, `count` of them.
void sort_best(std::vector<Candidate>& candidates, std::size_t count) {
  std::partial_sort(candidates.begin(),
                    candidates.begin() + static_cast<std::ptrdiff_t>(count),
                    candidates.end(),
                    better);
}

constexpr double kSidePx = 48;  // geometric mean of the object's sides in its patch
constexpr int kColumns = 14;    // of points
constexpr int kRows = 8;        // in the object's usual aspect
constexpr int kWindowPx = 9;    // of the optical flow: the side of a point's surroundings
// Points with less than this share of the strongest texture in the object are left out.
constexpr double kMinTexture = 0.05;
constexpr std::size_t kMinPoints = 20;  // for a median that holds
// Number of pairs of points, for a median that holds.
constexpr std::size_t kMinPairs = 50;
constexpr double kMinApartPx = 5;  // of a pair, whose ratio is else mostly the flow's error
constexpr float kMaxReturnPx = 1;  // from where a point began, forward and backward
constexpr double kMaxChange =
    0.1;  // of the size from a frame to the next: at 10 Hz, 1 s from a pass

using Points = std::vector<cv::Point2f>;

// The object and half its size around it.
image::Plane patch(const image::Plane& luma, const Box& box) {
  const double unit = std::sqrt(box.area()) / kSidePx;
  return resampled(luma,
                   box.x - box.width / 2,
                   box.y - box.height / 2,
                   unit,
                   static_cast<int>(std::lround(2 * box.width / unit)),
                   static_cast<int>(std::lround(2 * box.height / unit)));
}

// A grid of points over the object, at places with texture.
Points points_in(const cv::Mat& picture) {
  cv::Mat texture;
  cv::cornerMinEigenVal(picture, texture, kWindowPx);
  const cv::Rect object(picture.cols / 4, picture.rows / 4, picture.cols / 2, picture.rows / 2);
  double strongest = 0;
  cv::minMaxLoc(texture(object), nullptr, &strongest);
  Points points;
  for (int j = 0; j < kRows; ++j)
    for (int i = 0; i < kColumns; ++i) {
      const double x = picture.cols * (0.25 + 0.5 * (i + 0.5) / kColumns);
      const double y = picture.rows * (0.25 + 0.5 * (j + 0.5) / kRows);
      if (texture.at<float>(static_cast<int>(y), static_cast<int>(x)) >= kMinTexture * strongest)
        points.emplace_back(static_cast<float>(x), static_cast<float>(y));
    }
  return points;
}

struct Flow {
  Points from, to;
};

// Points that return to their origin when they are tracked forward and backward.
Flow followed(const cv::Mat& before, const cv::Mat& after, const Points& points) {
  Points there;
  Points back;
  std::vector<std::uint8_t> found;
  std::vector<std::uint8_t> returned;
  std::vector<float> unused;
  const cv::Size window(kWindowPx, kWindowPx);
  // The search for a point ends after 30 rounds, or once it moves by less than 0.01 px; the last
  // number is the least eigenvalue of the normal matrix. All are OpenCV's defaults.
  const cv::TermCriteria enough(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 30, 0.01);
  const auto flow = opencv_plugin::functions().calc_optical_flow_pyr_lk;
  flow(before, after, points, there, found, unused, window, 2, enough, 0, 1e-4);
  flow(after, before, there, back, returned, unused, window, 2, enough, 0, 1e-4);
  std::vector<float> off;
  for (std::size_t i = 0; i < points.size(); ++i)
    off.push_back(found[i] != 0 && returned[i] != 0
                      ? static_cast<float>(cv::norm(points[i] - back[i]))
                      : INFINITY);
  std::vector<float> sorted = off;
  std::erase(sorted, INFINITY);
  if (sorted.empty()) return {};
  const float most = std::min(kMaxReturnPx, median(std::move(sorted)));
  Flow result;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (off[i] <= most) {
      result.from.push_back(points[i]);
      result.to.push_back(there[i]);
    }
  return result;
}

// Median over pairs of points of the ratio of their distances.
std::optional<double> median_ratio(const Flow& flow) {
  std::vector<double> ratios;
  for (std::size_t a = 0; a < flow.from.size(); ++a)
    for (std::size_t b = a + 1; b < flow.from.size(); ++b)
      if (const double apart = cv::norm(flow.from[a] - flow.from[b]); apart >= kMinApartPx)
        ratios.push_back(cv::norm(flow.to[a] - flow.to[b]) / apart);
  if (ratios.size() < kMinPairs) return std::nullopt;
  return median(std::move(ratios));
}

// The growth of an object from one frame to the next by the optical flow of points within it (the
// median flow of Kalal, Mikolajczyk and Matas 2010, "Forward-backward error: automatic detection of
// tracking failures", section 4): the ratio of sizes, between 0.9 and 1.1. Points without texture
// are left out, because they belong to the sky in the box's corners and do not move. `kept` is the
// object's patch of the frame before; `box` is its present place at its old size. Empty where too
// few points can be followed.
std::optional<double> growth(const image::Plane& kept, const image::Plane& luma, const Box& box) {
  const image::Plane now = patch(luma, box);
  if (now.width != kept.width || now.height != kept.height) return std::nullopt;
  const Points points = points_in(image::mat_of(kept));
  if (points.size() < kMinPoints) return std::nullopt;
  const Flow flow = followed(image::mat_of(kept), image::mat_of(now), points);
  if (flow.from.size() < kMinPoints) return std::nullopt;
  const auto ratio = median_ratio(flow);
  if (!ratio) return std::nullopt;
  return std::clamp(*ratio, 1 - kMaxChange, 1 + kMaxChange);
}

class Am3 : public Tracker {
 public:
  explicit Am3(const Am3Options& options)
      : options_(options), random_(Seed(options.seed).stream("negatives")) {}

  // Of R'G'B' the green plane, in which an aircraft's pattern is followed as well.
  void load(const image::Picture& picture) override { luma_ = &picture.luma(); }

  void init(const Box& box) override {
    check(luma_ != nullptr, "a frame is loaded");
    refuse_unsound(box, luma_->width, luma_->height);
    random_ = Seed(options_.seed).stream("negatives");
    begin(box);
  }

  Answer update() override {
    check(!classifiers_.empty(), "a tracker is begun before it goes on");
    Answer answer = find();
    if (options_.follows_scale && !answer.lost) {
      follow_scale();
      answer.box_px = box();
      if (scale_ > kAnew || scale_ < 1 / kAnew) {
        begin(box());
        return answer;
      }
      kept_ = patch(*luma_, box());
    }
    learn(false);
    return answer;
  }

 private:
  // Of the object: its size in pixels of the template, of which `scale_` lie in one of the picture.
  void begin(const Box& box) {
    scale_ = 1;
    object_width_ = box.width;
    object_height_ = box.height;
    width_ = window_side(box.width, luma_->width);
    height_ = window_side(box.height, luma_->height);
    x_ = held(box.x + (box.width - width_) / 2, luma_->width - width_);
    y_ = held(box.y + (box.height - height_) / 2, luma_->height - height_);
    const double side = std::min(width_, height_);
    levels_ = std::clamp(
        1 + static_cast<int>(std::floor(std::log2(side / kMinSidePx))), 1, options_.levels);
    classifiers_.clear();
    for (int level = 0; level < levels_; ++level)
      for (int voter = 0; voter < options_.voters; ++voter)
        classifiers_.emplace_back(
            options_,
            level,
            side_at(width_, level),
            side_at(height_, level),
            Seed(options_.seed).stream("pool", static_cast<std::uint64_t>(level * 100 + voter)));
    hard_.assign(static_cast<std::size_t>(levels_), {});
    learn(true);
    if (options_.follows_scale) kept_ = patch(*luma_, box);
  }

  static int window_side(double side, int most) {
    return std::min(most, std::max(kMinWindowPx, static_cast<int>(std::lround(side))));
  }
  static double held(double value, int most) {
    return std::round(std::clamp<double>(value, 0, std::max(0, most)));
  }
  static int side_at(int side, int level) { return std::max(kMinTemplatePx, side >> level); }
  int reach() const { return static_cast<int>(std::ceil(options_.search_radius_px / scale_)); }
  Classifier& classifier(int level, int voter) {
    return classifiers_[static_cast<std::size_t>(level * options_.voters + voter)];
  }

  // Returns the object's box for the window's present place; the two differ in size.
  Box box() const {
    const double width = object_width_ * scale_;
    const double height = object_height_ * scale_;
    return {
        x_ + (width_ * scale_ - width) / 2, y_ + (height_ * scale_ - height) / 2, width, height};
  }

  // What windows within `reach` template pixels of the object's touch.
  LumaWindow view_around(int reach) const {
    const int block = 1 << (levels_ - 1);
    const int wanted = reach + 2 * block + kMinTemplatePx * block;
    const int margin = (wanted + block - 1) / block * block;
    if (scale_ == 1) {
      const int x = static_cast<int>(x_);
      const int y = static_cast<int>(y_);
      // Left and top are whole pixels of the coarsest level, so that levels meet.
      const int left = std::max(0, x - margin) / block * block;
      const int top = std::max(0, y - margin) / block * block;
      const PixelBox part{left, top, x + width_ + margin - left, y + height_ + margin - top};
      return {Pyramid(*luma_, part), double(left), double(top), 1};
    }
    const int width = width_ + 2 * margin;
    const int height = height_ + 2 * margin;
    const double left = x_ - margin * scale_;
    const double top = y_ - margin * scale_;
    const image::Plane plane = resampled(*luma_, left, top, scale_, width, height);
    return {Pyramid(plane, {0, 0, width, height}), left, top, scale_};
  }

  // Whether a window of the view lies in the picture.
  bool fits(const LumaWindow& view, int level, const Place& place) const {
    if (place.x < 0 || place.y < 0 ||
        place.x + side_at(width_, level) > view.pyramid.width(level) ||
        place.y + side_at(height_, level) > view.pyramid.height(level))
      return false;
    if (view.scale == 1) return true;  // a view at full resolution ends with the picture
    const double unit = view.scale * (1 << level);
    const double x = view.left + place.x * unit;
    const double y = view.top + place.y * unit;
    return x >= -unit && y >= -unit && x + width_ * view.scale <= luma_->width + unit &&
           y + height_ * view.scale <= luma_->height + unit;
  }

  Place place_of(const LumaWindow& view, int level, double x, double y) const {
    const double unit = view.scale * (1 << level);
    return {static_cast<int>(std::lround((x - view.left) / unit)),
            static_cast<int>(std::lround((y - view.top) / unit))};
  }

  // Every window of the coarsest level within the search radius.
  std::vector<Candidate> first_candidates(const LumaWindow& view) const {
    const int level = levels_ - 1;
    const Place centre = place_of(view, level, x_, y_);
    const int radius = std::max(1, (reach() + (1 << level) - 1) >> level);
    std::vector<Candidate> candidates;
    for (int dy = -radius; dy <= radius; ++dy)
      for (int dx = -radius; dx <= radius; ++dx) {
        const Place place{centre.x + dx, centre.y + dy};
        if (dx * dx + dy * dy < radius * radius && fits(view, level, place))
          candidates.push_back({place, 0, 0});
      }
    return candidates;
  }

  // Each voter gives every window exp((score - best) / spread), in (0, 1].
  void vote(const LumaWindow& view, int level, std::vector<Candidate>& candidates) {
    std::vector<Place> places;
    places.reserve(candidates.size());
    for (Candidate& candidate : candidates) {
      candidate.score = 0;
      places.push_back(candidate.place);
    }
    for (int voter = 0; voter < options_.voters; ++voter) {
      const std::vector<float> scores = classifier(level, voter).scores(view.pyramid, places);
      double sum = 0;
      double squares = 0;
      float best = -INFINITY;
      for (const float score : scores) {
        sum += score;
        squares += double{score} * score;
        best = std::max(best, score);
      }
      const double n = static_cast<double>(candidates.size());
      const double spread = std::sqrt(std::max(1e-6, squares / n - sum / n * sum / n));
      for (std::size_t i = 0; i < candidates.size(); ++i) {
        candidates[i].vote += static_cast<float>(std::exp((scores[i] - best) / spread)) /
                              static_cast<float>(options_.voters);
        candidates[i].score += scores[i];
      }
    }
  }

  // The best candidates, each as the windows of the next finer level that it covers.
  std::vector<Candidate> refined(const LumaWindow& view,
                                 int level,
                                 std::vector<Candidate> candidates) const {
    const std::size_t keep = std::min(
        candidates.size(),
        std::max(kMinSurvivors,
                 static_cast<std::size_t>(kSurvivors * static_cast<double>(candidates.size()))));
    sort_best(candidates, keep);
    std::map<std::pair<int, int>, float> votes;
    for (std::size_t i = 0; i < keep; ++i)
      for (int dy = -1; dy <= 2; ++dy)
        for (int dx = -1; dx <= 2; ++dx) {
          const Place place{2 * candidates[i].place.x + dx, 2 * candidates[i].place.y + dy};
          if (!fits(view, level - 1, place)) continue;
          float& known = votes[{place.y, place.x}];
          known = std::max(known, candidates[i].vote);
        }
    std::vector<Candidate> finer;
    for (const auto& [place, vote] : votes) finer.push_back({{place.second, place.first}, vote, 0});
    return finer;
  }

  Answer find() {
    const LumaWindow view = view_around(reach());
    std::vector<Candidate> candidates = first_candidates(view);
    for (int level = levels_ - 1; level >= 0 && !candidates.empty(); --level) {
      vote(view, level, candidates);
      if (options_.hard > 0) remember_alike(view, level, candidates);
      if (level > 0) candidates = refined(view, level, std::move(candidates));
    }
    Answer answer;
    answer.lost = candidates.empty();
    if (!candidates.empty()) {
      const Candidate& found = *std::min_element(candidates.begin(), candidates.end(), better);
      x_ = view.left + found.place.x * view.scale;
      y_ = view.top + found.place.y * view.scale;
    }
    answer.box_px = box();
    return answer;
  }

  // Windows with the highest votes, at some distance from one another. Which of them are negatives
  // is known only after the object is found, so three times as many are kept as will be learned.
  void remember_alike(const LumaWindow& view, int level, std::vector<Candidate> candidates) {
    const std::size_t looked = std::min(candidates.size(), kHardLooked);
    sort_best(candidates, looked);
    std::vector<Pixel>& alike = hard_[static_cast<std::size_t>(level)];
    alike.clear();
    const double unit = view.scale * (1 << level);
    for (std::size_t i = 0; i < looked && std::ssize(alike) < 3 * options_.hard; ++i) {
      const Pixel corner(view.left + candidates[i].place.x * unit,
                         view.top + candidates[i].place.y * unit);
      if (std::none_of(alike.begin(), alike.end(), [&](const Pixel& other) {
            return (corner - other).norm() < kHardApartPx * unit;
          }))
        alike.push_back(corner);
    }
  }

  bool is_elsewhere(const Place& a, const Place& b, int level) const {
    const int width = side_at(width_, level);
    const int height = side_at(height_, level);
    const double shared = double(std::max(0, width - std::abs(a.x - b.x))) *
                          std::max(0, height - std::abs(a.y - b.y));
    return shared / (2.0 * width * height - shared) <= kHardOverlap;
  }

  void follow_scale() {
    const Box now = box();
    const auto ratio = growth(kept_, *luma_, now);
    if (!ratio) return;
    const bool too_small = *ratio < 1 && now.width * *ratio < kMinObjectPx;
    if (too_small || now.width * *ratio > luma_->width || now.height * *ratio > luma_->height)
      return;
    // About its middle.
    x_ += width_ * scale_ * (1 - *ratio) / 2;
    y_ += height_ * scale_ * (1 - *ratio) / 2;
    scale_ *= *ratio;
  }

  void learn(bool is_first) {
    const double outermost = (is_first ? 2.0 : 1.5) * options_.search_radius_px / scale_;
    const LumaWindow view = view_around(static_cast<int>(std::ceil(outermost)));
    const double radius =
        std::min(options_.positive_radius_px,
                 options_.positive_share * std::min(object_width_, object_height_));
    for (int level = 0; level < levels_; ++level) {
      const double unit = 1 << level;
      const Place centre = place_of(view, level, x_, y_);
      std::vector<Place> positives;
      std::vector<float> distance_px;
      add_positives(view, level, centre, std::max(1.5, radius / unit), positives, distance_px);
      const double inner = (is_first ? 1.5 * radius : radius + options_.gap_px) / unit;
      std::vector<Place> negatives =
          around(view, level, centre, inner, std::max(inner + 3, outermost / unit));
      add_hard(view, level, centre, negatives);
      for (int voter = 0; voter < options_.voters; ++voter)
        classifier(level, voter).learn(view.pyramid, positives, distance_px, negatives);
    }
  }

  void add_positives(const LumaWindow& view,
                     int level,
                     const Place& centre,
                     double radius,
                     std::vector<Place>& places,
                     std::vector<float>& distance_px) const {
    const int reach = static_cast<int>(std::ceil(radius));
    for (int dy = -reach; dy <= reach; ++dy)
      for (int dx = -reach; dx <= reach; ++dx) {
        const Place place{centre.x + dx, centre.y + dy};
        const double distance = std::hypot(dx, dy);
        if (distance >= radius || !fits(view, level, place)) continue;
        places.push_back(place);
        distance_px.push_back(static_cast<float>(distance * (1 << level)));
      }
  }

  // Random windows from an annulus around the object.
  std::vector<Place> around(
      const LumaWindow& view, int level, const Place& centre, double inner, double outer) {
    std::vector<Place> places;
    for (int tries = 0; tries < 40 * options_.negatives && std::ssize(places) < options_.negatives;
         ++tries) {
      const int dx = static_cast<int>(std::lround(random_.uniform(-outer, outer)));
      const int dy = static_cast<int>(std::lround(random_.uniform(-outer, outer)));
      const double distance = std::hypot(dx, dy);
      const Place place{centre.x + dx, centre.y + dy};
      if (distance >= inner && distance < outer && fits(view, level, place))
        places.push_back(place);
    }
    return places;
  }

  void add_hard(const LumaWindow& view,
                int level,
                const Place& centre,
                std::vector<Place>& negatives) const {
    int added = 0;
    for (const Pixel& corner : hard_[static_cast<std::size_t>(level)]) {
      const Place place = place_of(view, level, corner.x(), corner.y());
      if (added == options_.hard) return;
      if (!is_elsewhere(place, centre, level) || !fits(view, level, place)) continue;
      negatives.push_back(place);
      ++added;
    }
  }

  Am3Options options_;
  const image::Plane* luma_ = nullptr;
  double object_width_ = 0;  // template pixels
  double object_height_ = 0;
  int width_ = 0;  // of the window, template pixels
  int height_ = 0;
  double scale_ = 1;  // picture pixels a template pixel
  double x_ = 0;      // the window's corner in the picture; whole where the scale is 1
  double y_ = 0;
  int levels_ = 1;
  std::vector<Classifier> classifiers_;   // [level * voters + voter]
  std::vector<std::vector<Pixel>> hard_;  // by level: corners in the picture
  image::Plane kept_;  // the object's patch of the frame before, where the scale is followed
  Random random_;
};

}  // namespace

std::unique_ptr<Tracker> make_am3(std::string_view name, std::uint64_t seed) {
  const bool is_mil = name == "mil";
  const bool is_single = is_mil || name == "wmil";
  if (!is_single && name != "am3" && name != "am3s") return nullptr;
  Am3Options options{.seed = seed, .follows_scale = name == "am3s"};
  if (is_single) {
    options.search_radius_px = 25;
    options.levels = 1;
    options.voters = 1;
    options.pool = 150;
    options.selected = 15;
    options.memory = 0.85;
    options.positive_share = INFINITY;
    options.gap_px = 4;
    options.hard = 0;
  }
  if (is_mil) {
    options.pool = 250;
    options.selected = 50;
    options.negatives = 65;
    options.weighted = false;
  }
  return std::make_unique<Am3>(options);
}

}  // namespace airtruth::tracking
