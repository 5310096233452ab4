// SPDX-License-Identifier: Apache-2.0
#include "tracking/am3.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "base/error.h"
#include "base/seed.h"
#include "tracking/classifier.h"

namespace airtruth::tracking {
namespace {

constexpr int kLeastSidePx = 6;    // of the object at the coarsest level
constexpr int kLeastWindowPx = 8;  // a smaller object is looked at with some of its surroundings
constexpr int kLeastTemplatePx = 5;
constexpr std::size_t kLeastSurvivors = 12;
constexpr double kSurvivors = 0.02;  // share of a level's candidates that the next one looks at

struct Candidate {
  Place place;
  float vote = 0;
  float score = 0;  // of the level's voters
};

class Am3 : public Tracker {
 public:
  explicit Am3(const Am3Options& options) : options_(options) {}

  void load(const image::Picture& picture) override { luma_ = &picture.luma(); }

  void init(const Box& box) override {
    check(luma_ != nullptr, "a frame is loaded");
    const bool sound = box.width > 0 && box.height > 0 && std::isfinite(box.area()) &&
                       std::isfinite(box.x) && std::isfinite(box.y);
    if (!sound || !intersection(pixels_of(box), {0, 0, luma_->width, luma_->height}))
      throw Error("the first box has no area within the picture");
    box_ = box;
    width_ = window_side(box.width, luma_->width);
    height_ = window_side(box.height, luma_->height);
    x_ = held(box.x + (box.width - width_) / 2, luma_->width - width_);
    y_ = held(box.y + (box.height - height_) / 2, luma_->height - height_);
    const double side = std::min(width_, height_);
    levels_ = std::clamp(
        1 + static_cast<int>(std::floor(std::log2(side / kLeastSidePx))), 1, options_.levels);
    classifiers_.clear();
    for (int level = 0; level < levels_; ++level)
      for (int voter = 0; voter < options_.voters; ++voter)
        classifiers_.emplace_back(
            options_,
            level,
            side_at(width_, level),
            side_at(height_, level),
            Seed(options_.seed).stream("pool", static_cast<std::uint64_t>(level * 100 + voter)));
    random_ = Seed(options_.seed).stream("negatives");
    learn(true);
  }

  Answer update() override {
    check(!classifiers_.empty(), "a tracker is begun before it goes on");
    const Answer answer = find();
    learn(false);
    return answer;
  }

 private:
  static int window_side(double side, int most) {
    return std::min(most, std::max(kLeastWindowPx, static_cast<int>(std::lround(side))));
  }
  static int held(double value, int most) {
    return static_cast<int>(std::lround(std::clamp<double>(value, 0, std::max(0, most))));
  }
  static int side_at(int side, int level) { return std::max(kLeastTemplatePx, side >> level); }

  // Of the picture, what windows within `reach` of the object's touch.
  Pyramid pyramid_around(int reach) const {
    const int block = 1 << (levels_ - 1);
    const int margin = reach + 2 * block + kLeastTemplatePx * block;
    // Left and top are whole pixels of the coarsest level, so that levels meet.
    const int left = std::max(0, x_ - margin) / block * block;
    const int top = std::max(0, y_ - margin) / block * block;
    return Pyramid(
        *luma_, {left, top, x_ + width_ + margin - left, y_ + height_ + margin - top}, levels_);
  }

  bool fits(const Pyramid& pyramid, int level, const Place& place) const {
    return place.x >= 0 && place.y >= 0 &&
           place.x + side_at(width_, level) <= pyramid.width(level) &&
           place.y + side_at(height_, level) <= pyramid.height(level);
  }

  Place place_at(const Pyramid& pyramid, int level) const {
    const double scale = 1 << level;
    return {static_cast<int>(std::lround((x_ - pyramid.left()) / scale)),
            static_cast<int>(std::lround((y_ - pyramid.top()) / scale))};
  }

  // Every window of the coarsest level within the search radius.
  std::vector<Candidate> first_candidates(const Pyramid& pyramid) const {
    const int level = levels_ - 1;
    const Place centre = place_at(pyramid, level);
    const int radius = std::max(1, (options_.search_radius_px + (1 << level) - 1) >> level);
    std::vector<Candidate> candidates;
    for (int dy = -radius; dy <= radius; ++dy)
      for (int dx = -radius; dx <= radius; ++dx) {
        const Place place{centre.x + dx, centre.y + dy};
        if (dx * dx + dy * dy < radius * radius && fits(pyramid, level, place))
          candidates.push_back({place, 0, 0});
      }
    return candidates;
  }

  // Each voter gives every window exp((score - best) / spread), in (0, 1].
  void vote(const Pyramid& pyramid, int level, std::vector<Candidate>& candidates) const {
    std::vector<float> scores(candidates.size());
    for (Candidate& candidate : candidates) candidate.score = 0;
    for (int voter = 0; voter < options_.voters; ++voter) {
      const Classifier& classifier =
          classifiers_[static_cast<std::size_t>(level * options_.voters + voter)];
      double sum = 0;
      double squares = 0;
      float best = -INFINITY;
      for (std::size_t i = 0; i < candidates.size(); ++i) {
        scores[i] = classifier.score(pyramid, candidates[i].place);
        sum += scores[i];
        squares += double{scores[i]} * scores[i];
        best = std::max(best, scores[i]);
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

  static bool better(const Candidate& a, const Candidate& b) {
    if (a.vote != b.vote) return a.vote > b.vote;
    if (a.score != b.score) return a.score > b.score;
    return a.place.y != b.place.y ? a.place.y < b.place.y : a.place.x < b.place.x;
  }

  // The best few, each as the windows of the next finer level that it stands for.
  std::vector<Candidate> refined(const Pyramid& pyramid,
                                 int level,
                                 std::vector<Candidate> candidates) const {
    const std::size_t keep = std::min(
        candidates.size(),
        std::max(kLeastSurvivors,
                 static_cast<std::size_t>(kSurvivors * static_cast<double>(candidates.size()))));
    std::partial_sort(candidates.begin(),
                      candidates.begin() + static_cast<std::ptrdiff_t>(keep),
                      candidates.end(),
                      better);
    std::map<std::pair<int, int>, float> votes;
    for (std::size_t i = 0; i < keep; ++i)
      for (int dy = -1; dy <= 2; ++dy)
        for (int dx = -1; dx <= 2; ++dx) {
          const Place place{2 * candidates[i].place.x + dx, 2 * candidates[i].place.y + dy};
          if (!fits(pyramid, level - 1, place)) continue;
          float& known = votes[{place.y, place.x}];
          known = std::max(known, candidates[i].vote);
        }
    std::vector<Candidate> finer;
    for (const auto& [place, vote] : votes) finer.push_back({{place.second, place.first}, vote, 0});
    return finer;
  }

  Answer find() {
    const Pyramid pyramid = pyramid_around(options_.search_radius_px);
    std::vector<Candidate> candidates = first_candidates(pyramid);
    for (int level = levels_ - 1; level >= 0 && !candidates.empty(); --level) {
      vote(pyramid, level, candidates);
      if (level > 0) candidates = refined(pyramid, level, std::move(candidates));
    }
    Answer answer;
    answer.lost = candidates.empty();
    if (!candidates.empty()) {
      const Candidate& found = *std::min_element(candidates.begin(), candidates.end(), better);
      x_ = pyramid.left() + found.place.x;
      y_ = pyramid.top() + found.place.y;
      answer.confidence = found.vote / static_cast<double>(levels_);
    } else {
      answer.confidence = 0;
    }
    answer.box_px = {
        x_ + (width_ - box_.width) / 2, y_ + (height_ - box_.height) / 2, box_.width, box_.height};
    return answer;
  }

  void learn(bool is_first) {
    const double outermost =
        is_first ? 2.0 * options_.search_radius_px : 1.5 * options_.search_radius_px;
    const Pyramid pyramid = pyramid_around(static_cast<int>(std::ceil(outermost)));
    for (int level = 0; level < levels_; ++level) {
      const double scale = 1 << level;
      const Place centre = place_at(pyramid, level);
      const double positive = std::max(1.5, options_.positive_radius_px / scale);
      const double inner =
          (is_first ? 1.5 * options_.positive_radius_px : options_.positive_radius_px + 4) / scale;
      const double outer = std::max(inner + 3, outermost / scale);
      std::vector<Place> positives;
      std::vector<float> distance_px;
      const int reach = static_cast<int>(std::ceil(positive));
      for (int dy = -reach; dy <= reach; ++dy)
        for (int dx = -reach; dx <= reach; ++dx) {
          const Place place{centre.x + dx, centre.y + dy};
          const double distance = std::hypot(dx, dy);
          if (distance >= positive || !fits(pyramid, level, place)) continue;
          positives.push_back(place);
          distance_px.push_back(static_cast<float>(distance * scale));
        }
      const std::vector<Place> negatives = around(pyramid, level, centre, inner, outer);
      for (int voter = 0; voter < options_.voters; ++voter)
        classifiers_[static_cast<std::size_t>(level * options_.voters + voter)].learn(
            pyramid, positives, distance_px, negatives);
    }
  }

  // Windows drawn from an annulus about the object.
  std::vector<Place> around(
      const Pyramid& pyramid, int level, const Place& centre, double inner, double outer) {
    std::vector<Place> places;
    for (int tries = 0; tries < 40 * options_.negatives && std::ssize(places) < options_.negatives;
         ++tries) {
      const int dx = static_cast<int>(std::lround(random_.uniform(-outer, outer)));
      const int dy = static_cast<int>(std::lround(random_.uniform(-outer, outer)));
      const double distance = std::hypot(dx, dy);
      const Place place{centre.x + dx, centre.y + dy};
      if (distance >= inner && distance < outer && fits(pyramid, level, place))
        places.push_back(place);
    }
    return places;
  }

  Am3Options options_;
  const image::Plane* luma_ = nullptr;
  Box box_;        // of the object: its size is kept
  int width_ = 0;  // of the window
  int height_ = 0;
  int x_ = 0;  // its corner
  int y_ = 0;
  int levels_ = 1;
  std::vector<Classifier> classifiers_;  // [level * voters + voter]
  Random random_{0};
};

}  // namespace

Am3Options mil_options(std::uint64_t seed) {
  Am3Options options;
  options.seed = seed;
  options.search_radius_px = 25;
  options.levels = 1;
  options.voters = 1;
  options.pool = 250;
  options.selected = 50;
  options.negatives = 65;
  options.weighted = false;
  return options;
}

Am3Options wmil_options(std::uint64_t seed) {
  Am3Options options;
  options.seed = seed;
  options.search_radius_px = 25;
  options.levels = 1;
  options.voters = 1;
  return options;
}

std::unique_ptr<Tracker> make_am3(const Am3Options& options) {
  return std::make_unique<Am3>(options);
}

}  // namespace airtruth::tracking
