// SPDX-License-Identifier: Apache-2.0
#include "studio/session/clip.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "foundation/base/error.h"
#include "foundation/image/colour.h"
#include "foundation/image/cuts.h"
#include "sequence/pipeline/resolved_scene.h"
#include "show/drawing/draw.h"
#include "studio/session/answers.h"

namespace airtruth::session {
namespace {

// Decoded frames that are kept: some 200 of 1280 x 960.
constexpr std::size_t kMostBytes = std::size_t{400} << 20;
// Farther ahead a new reader from the key frame before is faster: the usual distance of key frames.
constexpr std::int64_t kReadOn = 100;
// A step back is one of several. What lies before is decoded from the key frame on in any case.
constexpr std::int64_t kReadBefore = 60;
// Glances, each of some 20 kB, and thumbnails that are kept.
constexpr std::size_t kMostGlances = 4000;
constexpr std::size_t kMostThumbnails = 1000;
// Bytes of a video whose frames' times are read although its rate is said to be constant: a disk
// gives them in some seconds. Dropped frames of a larger one are not seen.
constexpr std::uintmax_t kMostIndexed = std::uintmax_t{1} << 30;

}  // namespace

std::string text_of(const scene::Background& background) {
  scene::Scene scene;
  scene.background = background;
  return scene::toml_from_scene(scene);
}

Clip::Clip(const scene::Background& background, pipeline::Options options)
    : options_(std::move(options)) {
  scene_.background = background;
  reader_.emplace(open(0));
  info_ = reader_->info();
  const std::int64_t first = background.first_frame;
  begin_s_ = static_cast<double>(first) / rate_hz();
  std::error_code none;
  if (!info_.variable_frame_rate && fs::file_size(background.video, none) > kMostIndexed) return;
  read_on();
  // Of a container that states no number of frames, the time stamps are counted: its length and
  // rate tell too many or too few where the rate varies.
  const bool is_counted = !info_.is_frame_count_stated;
  std::vector<double> times_s = reader_->times_s(
      is_counted ? background.frame_count.value_or(video::kAllFrames) : frame_count());
  if (is_counted && !times_s.empty()) info_.frame_count_estimate = first + std::ssize(times_s);
  if (video::are_of_rate(times_s, rate_hz())) return;
  times_s_ = std::move(times_s);
  if (first > 0) begin_s_ = video::time_of_first_frame_s(background.video, {.first_frame = first});
}

std::int64_t Clip::frame_near(double time_s) const {
  if (times_s_.empty() || time_s <= 0) return std::llround(time_s * rate_hz());
  if (time_s >= times_s_.back())
    return std::ssize(times_s_) - 1 + std::llround((time_s - times_s_.back()) * rate_hz());
  const auto after = std::ranges::upper_bound(times_s_, time_s);
  const bool is_nearer = *after - time_s <= time_s - *(after - 1);
  return after - times_s_.begin() - (is_nearer ? 0 : 1);
}

std::int64_t Clip::frame_count() const {
  const std::int64_t left =
      std::max<std::int64_t>(1, info_.frame_count_estimate - scene_.background.first_frame);
  const std::int64_t stated = std::min(left, scene_.background.frame_count.value_or(left));
  return end_ ? std::min(stated, *end_) : stated;
}

video::Reader Clip::open(std::int64_t first) const {
  scene::Scene from = scene_;
  from.background.first_frame += first;
  if (from.background.frame_count)
    from.background.frame_count = std::max<std::int64_t>(1, *from.background.frame_count - first);
  return pipeline::open_background(from, options_);
}

std::shared_ptr<const video::Frame> Clip::frame(std::int64_t k) {
  if (const auto found = places_.find(k); found != places_.end()) {
    kept_.splice(kept_.begin(), kept_, found->second);
    return found->second->second;
  }
  if (k < 0 || (end_ && k >= *end_) ||
      (scene_.background.frame_count && k >= *scene_.background.frame_count))
    throw Error(fmt::format("has no frame {}; expected 0 to {}", k, frame_count() - 1),
                {scene_.background.video.string()});
  if (!first_pts_) read_on();
  if (!reader_ || k < next_ || k > next_ + kReadOn) seek(k);
  while (next_ <= k)
    if (!read_on()) {
      end_ = next_;
      reader_.reset();
      throw Error(fmt::format("has no frame {}; it ends after {}", k, next_),
                  {scene_.background.video.string()});
    }
  return places_.at(k)->second;
}

// A reader that begins in the middle does not know the cuts of its first frames.
void Clip::seek(std::int64_t k) {
  const bool steps_back = places_.count(k + 1) > 0;
  const std::int64_t wanted = steps_back ? k - kReadBefore : k;
  const std::int64_t first = std::max<std::int64_t>(0, wanted - image::kCutNeighbours - 1);
  reader_.emplace(open(first));
  next_ = first;
  first_sure_ = first == 0 ? 0 : std::max<std::int64_t>(0, wanted);
}

bool Clip::read_on() {
  auto read = reader_->next();
  if (!read) return false;
  const std::int64_t k = next_++;
  if (!first_pts_) first_pts_ = read->pts;
  // Numbered pictures count from the reader's first one.
  const bool is_counted = k == read->index || read->pts > *first_pts_;
  read->time_s = is_counted ? static_cast<double>(read->pts - *first_pts_) * info_.time_base.value()
                            : static_cast<double>(k) / rate_hz();
  read->index = k;
  if (k >= first_sure_) keep(k, std::make_shared<const video::Frame>(std::move(*read)));
  return true;
}

void Clip::keep(std::int64_t k, std::shared_ptr<const video::Frame> frame) {
  if (places_.count(k) > 0) return;
  seen_[k] = {frame->time_s, frame->begins_shot};
  bytes_ += frame->picture.bytes();
  if (glances_.count(k) == 0) {
    if (glances_.size() >= kMostGlances) glances_.clear();
    glances_[k] = insertion::glance_at(frame->picture, tone_);
  }
  kept_.emplace_front(k, std::move(frame));
  places_[k] = kept_.begin();
  while (bytes_ > kMostBytes && kept_.size() > 1) {
    bytes_ -= kept_.back().second->picture.bytes();
    places_.erase(kept_.back().first);
    kept_.pop_back();
  }
}

const insertion::Glance& Clip::glance(std::int64_t k, const image::ToneCurve& tone) {
  if (tone.gamma != tone_.gamma) {
    glances_.clear();
    tone_ = tone;
  }
  if (const auto found = glances_.find(k); found != glances_.end()) return found->second;
  const auto picture = frame(k);
  const auto [place, is_new] = glances_.try_emplace(k);
  if (is_new) place->second = insertion::glance_at(picture->picture, tone_);
  return place->second;
}

std::string Thumbnails::at(const scene::Background& background, std::int64_t k, int width) {
  const std::string clip = text_of(background);
  if (!reader_ || clip != clip_) {
    made_.clear();
    scene::Scene scene;
    scene.background = background;
    reader_.emplace(pipeline::open_background(scene, options_));
    clip_ = clip;
  }
  if (const auto found = made_.find({k, width}); found != made_.end()) return found->second;
  const auto frame = reader_->at(static_cast<double>(k) / reader_->info().frame_rate.value());
  if (!frame) throw Error(fmt::format("has no frame {}", k), {background.video.string()});
  const image::Rgb8 rgb = image::rgb8_from_picture(frame->picture);
  const int height = std::max(
      1, static_cast<int>(std::lround(static_cast<double>(rgb.height) * width / rgb.width)));
  if (made_.size() >= kMostThumbnails) made_.clear();
  return made_[{k, width}] = jpeg_of(drawing::resized(rgb, width, height, cv::INTER_AREA));
}

}  // namespace airtruth::session
