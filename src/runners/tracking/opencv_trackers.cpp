// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <mutex>
#include <type_traits>
#include <utility>

#include <fmt/format.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/tracking.hpp>
#include <opencv2/tracking/tracking_legacy.hpp>
#include <opencv2/video/tracking.hpp>

#include "camera/opencv_plugin/opencv_plugin.h"
#include "foundation/base/stopwatch.h"
#include "foundation/image/colour.h"
#include "foundation/image/mats.h"
#include "runners/process/child.h"
#include "runners/tracking/tracker.h"

namespace airtruth::tracking {
namespace {

// The least side of a window, px: random Haar features of MIL and Boosting fit into it.
constexpr double kMinHaarPx = 8;

cv::Mat bgr_of(const image::Picture& picture) {
  const image::Rgb8 rgb = image::rgb8_from_picture(picture);
  cv::Mat bgr;
  cv::cvtColor(image::mat_of(rgb), bgr, cv::COLOR_RGB2BGR);
  return bgr;
}

Box whole(const Box& box) {
  return {std::round(box.x),
          std::round(box.y),
          std::max(1.0, std::round(box.width)),
          std::max(1.0, std::round(box.height))};
}

// The box on which a tracker starts: the object, with some surroundings where it is small. OpenCV's
// MIL and Boosting draw random Haar features until some fit into the box; into a box of four by two
// pixels none ever fits.
class Window {
 public:
  Window() = default;
  Window(const Box& box, double least_px, const cv::Mat& frame) : box_(box), window_(box) {
    window_.width = std::min<double>(frame.cols, std::max(least_px, box.width));
    window_.height = std::min<double>(frame.rows, std::max(least_px, box.height));
    if (!is_larger()) return;
    window_.x =
        std::clamp(box.x - (window_.width - box.width) / 2, 0.0, frame.cols - window_.width);
    window_.y =
        std::clamp(box.y - (window_.height - box.height) / 2, 0.0, frame.rows - window_.height);
  }

  const Box& window() const { return window_; }
  // The object in a window that was found.
  Box object_in(const Box& found) const {
    if (!is_larger()) return found;
    const double across = found.width / window_.width;
    const double down = found.height / window_.height;
    return {found.x + (box_.x - window_.x) * across,
            found.y + (box_.y - window_.y) * down,
            box_.width * across,
            box_.height * down};
  }

 private:
  bool is_larger() const { return window_.width > box_.width || window_.height > box_.height; }
  Box box_;
  Box window_;
};

// A tracker of OpenCV's present interface, which takes whole pixels, or of its legacy one. Made
// anew for each start: a second init() of the same KCF writes past its buffers.
template <typename Library>
class OpenCvTracker : public Tracker {
  static constexpr bool kIsLegacy = std::is_same_v<Library, cv::legacy::Tracker>;
  using Rectangle = std::conditional_t<kIsLegacy, cv::Rect2d, cv::Rect>;

 public:
  OpenCvTracker(std::function<cv::Ptr<Library>()> make, std::uint64_t seed, double least_px)
      : make_(std::move(make)), seed_(seed), least_px_(least_px) {}

  void load(const image::Picture& picture) override { frame_ = bgr_of(picture); }
  void init(const Box& box) override {
    refuse_unsound(box, frame_.cols, frame_.rows);
    cv::theRNG().state = seed_;
    last_ = box;
    tracker_ = make_();
    // Boosting cuts a box between pixels in two ways and reads past its features: whole pixels for
    // what has a least size, as the present interface has them for all.
    const bool has_least = least_px_ > 0;
    window_ = Window(kIsLegacy && has_least ? whole(box) : box, least_px_, frame_);
    const Box start = kIsLegacy && !has_least ? window_.window() : whole(window_.window());
    const Rectangle rectangle = cv::Rect2d(start.x, start.y, start.width, start.height);
    broken_ = false;
    try {
      if constexpr (kIsLegacy)
        broken_ = !opencv_plugin::functions().init(*tracker_, frame_, rectangle);
      else
        tracker_->init(frame_, rectangle);
    } catch (const cv::Exception&) {
      broken_ = true;
    }
  }
  Answer update() override {
    if (broken_) return {.box_px = last_, .lost = true};
    Rectangle found;
    bool is_found = false;
    try {
      if constexpr (kIsLegacy)
        is_found = opencv_plugin::functions().update(*tracker_, frame_, found);
      else
        is_found = tracker_->update(frame_, found);
    } catch (const cv::Exception&) {  // for boxes at the border and for boxes of a few pixels
    }
    const Box b = window_.object_in(
        {double(found.x), double(found.y), double(found.width), double(found.height)});
    if (!is_found || !std::isfinite(b.x + b.y + b.width + b.height))
      return {.box_px = last_, .lost = true};
    last_ = b;
    return {.box_px = b};
  }

 protected:
  cv::Mat frame_;

 private:
  std::function<cv::Ptr<Library>()> make_;
  cv::Ptr<Library> tracker_;
  std::uint64_t seed_;
  double least_px_;
  Window window_;
  Box last_;
  bool broken_ = false;
};

// OpenCV's TLD learns the surroundings of an object from windows of its shape that hardly overlap
// it, of a grid over the picture, which is enlarged where the object is small. It draws for ever
// where there is no such window, and reads past the grid where that has none at all.
class Tld : public OpenCvTracker<cv::legacy::Tracker> {
 public:
  using OpenCvTracker::OpenCvTracker;
  void init(const Box& box) override {
    refuse_unsound(box, frame_.cols, frame_.rows);
    if (!has_surroundings(Window(box, 0, frame_).window()))
      throw process::Failure(
          fmt::format("cannot begin on {} x {} px: a picture of {} x {} has no surroundings for it",
                      box.width,
                      box.height,
                      frame_.cols,
                      frame_.rows));
    OpenCvTracker::init(box);
  }

 private:
  // The grid as OpenCV 4 makes it, whose numbers these are.
  bool has_surroundings(const Box& box) const {
    constexpr double kLeastSidePx = 20;  // of a window
    constexpr double kSizeStep = 1.2;
    constexpr double kStep = 0.1;  // of a window's side
    constexpr double kMostOverlap = 0.2;
    const double least = std::min(box.width, box.height);
    const double enlarged = std::max(1.0, kLeastSidePx / least);
    const double columns = std::round(frame_.cols * enlarged);
    const double rows = std::round(frame_.rows * enlarged);
    const cv::Rect2d object(
        box.x * enlarged, box.y * enlarged, box.width * enlarged, box.height * enlarged);
    double width = std::trunc(box.width * kLeastSidePx / least);
    double height = std::trunc(box.height * kLeastSidePx / least);
    // OpenCV compares a side with the other side of the picture.
    for (; height < columns && width < rows; width *= kSizeStep, height *= kSizeStep)
      for (double x = 0; x + width + 1 <= columns; x += kStep * width)
        for (double y = 0; y + height + 1 <= rows; y += kStep * height) {
          const double both = (object & cv::Rect2d(x, y, width, height)).area();
          if (both < kMostOverlap * (object.area() + width * height - both)) return true;
        }
    return false;
  }
};

// OpenCV's Haar features, boosting and TLD draw from the C library's rand(), one sequence for the
// whole process, so that a tracker's answers would depend on other trackers before and beside it.
// Here each tracker has its own sequence, from its own seed, and the trackers take turns.
class WithOwnRand : public Tracker {
 public:
  WithOwnRand(std::unique_ptr<Tracker> tracker, std::uint64_t seed)
      : tracker_(std::move(tracker)), seed_(static_cast<unsigned>(seed)) {
    const std::lock_guard lock(mutex());
    setstate(initstate(seed_, numbers_.data(), numbers_.size()));
  }
  void load(const image::Picture& picture) override { tracker_->load(picture); }
  void init(const Box& box) override {
    const Turn turn(numbers_.data());
    srandom(seed_);
    tracker_->init(box);
  }
  Answer update() override {
    const Turn turn(numbers_.data());
    const Stopwatch watch;
    Answer answer = tracker_->update();
    // Waiting for the turn is not the tracker's time.
    answer.seconds = watch.seconds();
    return answer;
  }

 private:
  static std::mutex& mutex() {
    static std::mutex one;
    return one;
  }
  // rand() draws from `numbers` as long as this lives.
  class Turn {
   public:
    explicit Turn(char* numbers) : lock_(mutex()), before_(setstate(numbers)) {}
    ~Turn() { setstate(before_); }
    Turn(const Turn&) = delete;
    Turn& operator=(const Turn&) = delete;

   private:
    std::lock_guard<std::mutex> lock_;
    char* before_;
  };

  std::unique_ptr<Tracker> tracker_;
  unsigned seed_;
  std::array<char, 128> numbers_{};  // a size that initstate(3) knows
};

}  // namespace

std::unique_ptr<Tracker> make_opencv_tracker(std::string_view name, std::uint64_t seed) {
  // A state of 0 would stay 0.
  const std::uint64_t state = seed * 2 + 1;
  if (!name.starts_with("opencv-")) return nullptr;
  const opencv_plugin::Functions& opencv = opencv_plugin::functions();
  const auto modern = [&](auto make, double least_px = 0) {
    return std::make_unique<OpenCvTracker<cv::Tracker>>(make, state, least_px);
  };
  const auto old = [&](auto make, double least_px = 0) {
    return std::make_unique<OpenCvTracker<cv::legacy::Tracker>>(make, state, least_px);
  };
  const auto with_own_rand = [&](std::unique_ptr<Tracker> tracker) {
    return std::make_unique<WithOwnRand>(std::move(tracker), seed);  // 1 is rand()'s own
  };
  if (name == "opencv-mil") return with_own_rand(modern(opencv.mil, kMinHaarPx));
  if (name == "opencv-kcf") return modern(opencv.kcf);
  if (name == "opencv-csrt") return modern(opencv.csrt);
  if (name == "opencv-boosting") return with_own_rand(old(opencv.boosting, kMinHaarPx));
  if (name == "opencv-medianflow") return old(opencv.median_flow);
  if (name == "opencv-tld") return with_own_rand(std::make_unique<Tld>(opencv.tld, state, 0));
  if (name == "opencv-mosse") return old(opencv.mosse);
  return nullptr;
}

}  // namespace airtruth::tracking
