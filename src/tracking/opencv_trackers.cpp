// SPDX-License-Identifier: Apache-2.0
#include "tracking/opencv_trackers.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/tracking.hpp>
#include <opencv2/tracking/tracking_legacy.hpp>
#include <opencv2/video/tracking.hpp>

#include "base/error.h"
#include "image/colour.h"

namespace airtruth::tracking {
namespace {

cv::Mat bgr_of(const image::Picture& picture) {
  image::Rgb8 rgb = image::rgb8_from_picture(picture);
  const cv::Mat shared(rgb.height, rgb.width, CV_8UC3, rgb.samples.get());
  cv::Mat bgr;
  cv::cvtColor(shared, bgr, cv::COLOR_RGB2BGR);
  return bgr;
}

void refuse_unsound(const Box& box, const cv::Mat& frame) {
  const bool sound = box.width > 0 && box.height > 0 && std::isfinite(box.area()) &&
                     std::isfinite(box.x) && std::isfinite(box.y);
  if (!sound || !intersection(pixels_of(box), {0, 0, frame.cols, frame.rows}))
    throw Error("the first box has no area within the picture");
}

// OpenCV throws for boxes at the border and of a few pixels; that is a tracker that lost its
// object.
Answer answer_of(const std::function<bool(Box&)>& update, const Box& last) {
  Answer answer{last, 1, false};
  try {
    answer.lost = !update(answer.box_px);
  } catch (const cv::Exception&) {
    answer.lost = true;
  }
  const Box& b = answer.box_px;
  if (!std::isfinite(b.x + b.y + b.width + b.height)) answer.lost = true;
  if (answer.lost) answer = {last, 0, true};
  return answer;
}

// cv::Tracker takes whole pixels. Made anew for each start: a second init() of the same KCF writes
// past its buffers.
class Modern : public Tracker {
 public:
  Modern(std::function<cv::Ptr<cv::Tracker>()> make, std::uint64_t seed)
      : make_(std::move(make)), seed_(seed) {}

  void load(const image::Picture& picture) override { frame_ = bgr_of(picture); }
  void init(const Box& box) override {
    refuse_unsound(box, frame_);
    cv::theRNG().state = seed_;
    last_ = box;
    broken_ = false;
    tracker_ = make_();
    const PixelBox whole{static_cast<int>(std::lround(box.x)),
                         static_cast<int>(std::lround(box.y)),
                         std::max(1, static_cast<int>(std::lround(box.width))),
                         std::max(1, static_cast<int>(std::lround(box.height)))};
    try {
      tracker_->init(frame_, {whole.x, whole.y, whole.width, whole.height});
    } catch (const cv::Exception&) {
      broken_ = true;
    }
  }
  Answer update() override {
    if (broken_) return {last_, 0, true};
    const Answer answer = answer_of(
        [&](Box& box) {
          cv::Rect found;
          if (!tracker_->update(frame_, found)) return false;
          box = {double(found.x), double(found.y), double(found.width), double(found.height)};
          return true;
        },
        last_);
    last_ = answer.box_px;
    return answer;
  }

 private:
  std::function<cv::Ptr<cv::Tracker>()> make_;
  cv::Ptr<cv::Tracker> tracker_;
  std::uint64_t seed_;
  cv::Mat frame_;
  Box last_;
  bool broken_ = false;
};

class Legacy : public Tracker {
 public:
  Legacy(std::function<cv::Ptr<cv::legacy::Tracker>()> make, std::uint64_t seed)
      : make_(std::move(make)), seed_(seed) {}

  void load(const image::Picture& picture) override { frame_ = bgr_of(picture); }
  void init(const Box& box) override {
    refuse_unsound(box, frame_);
    cv::theRNG().state = seed_;
    last_ = box;
    tracker_ = make_();
    try {
      broken_ = !tracker_->init(frame_, cv::Rect2d(box.x, box.y, box.width, box.height));
    } catch (const cv::Exception&) {
      broken_ = true;
    }
  }
  Answer update() override {
    if (broken_) return {last_, 0, true};
    const Answer answer = answer_of(
        [&](Box& box) {
          cv::Rect2d found;
          if (!tracker_->update(frame_, found)) return false;
          box = {found.x, found.y, found.width, found.height};
          return true;
        },
        last_);
    last_ = answer.box_px;
    return answer;
  }

 private:
  std::function<cv::Ptr<cv::legacy::Tracker>()> make_;
  cv::Ptr<cv::legacy::Tracker> tracker_;
  std::uint64_t seed_;
  cv::Mat frame_;
  Box last_;
  bool broken_ = false;
};

}  // namespace

std::unique_ptr<Tracker> make_opencv_tracker(std::string_view name, std::uint64_t seed) {
  // A state of 0 would stay 0.
  const std::uint64_t state = seed * 2 + 1;
  namespace legacy = cv::legacy;
  const auto modern = [&](auto make) { return std::make_unique<Modern>(make, state); };
  const auto old = [&](auto make) { return std::make_unique<Legacy>(make, state); };
  if (name == "opencv-mil") return modern([] { return cv::TrackerMIL::create(); });
  if (name == "opencv-kcf") return modern([] { return cv::TrackerKCF::create(); });
  if (name == "opencv-csrt") return modern([] { return cv::TrackerCSRT::create(); });
  if (name == "opencv-boosting") return old([] { return legacy::TrackerBoosting::create(); });
  if (name == "opencv-medianflow") return old([] { return legacy::TrackerMedianFlow::create(); });
  if (name == "opencv-tld") return old([] { return legacy::TrackerTLD::create(); });
  if (name == "opencv-mosse") return old([] { return legacy::TrackerMOSSE::create(); });
  return nullptr;
}

}  // namespace airtruth::tracking
