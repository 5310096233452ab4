// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <list>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "foundation/image/tone_curve.h"
#include "picture/video/reader.h"
#include "scene/scene/scene.h"
#include "sequence/insertion/ambient.h"
#include "sequence/pipeline/options.h"

namespace airtruth::session {

// The text of a background: the same for two exactly where their clips are.
std::string text_of(const scene::Background& background);

// The frames of a scene's clip in any order, with the indices and times that a reader from the
// clip's beginning gives them. Decoded frames are kept in bounded memory. Of one thread.
class Clip {
 public:
  Clip(const scene::Background& background, pipeline::Options options);

  // Of the whole video; its number of frames at least up to the end of the clip.
  const video::StreamInfo& info() const { return info_; }
  // Frames of the clip, as the container states it or by its time stamps; at least 1.
  std::int64_t frame_count() const;
  double rate_hz() const { return info_.frame_rate.value(); }
  // When the video shows its first frame, in seconds from the video's beginning.
  double begin_s() const { return begin_s_; }
  // Of a variable frame rate when each frame is shown, in seconds from the first; else empty.
  const std::vector<double>& times_s() const { return times_s_; }
  // The frame that is shown nearest to a time; beyond the clip by the rate.
  std::int64_t frame_near(double time_s) const;

  // Throws Error where the clip has no such frame.
  std::shared_ptr<const video::Frame> frame(std::int64_t k);
  // What the light is estimated from in frame k; kept longer than the frame.
  const insertion::Glance& glance(std::int64_t k, const image::ToneCurve& tone);
  bool has_glance(std::int64_t k) const { return glances_.count(k) > 0; }
  // The time of a frame that was read, and whether it begins a shot.
  double time_s(std::int64_t k) const { return seen_.at(k).time_s; }
  bool begins_shot(std::int64_t k) const { return seen_.at(k).begins_shot; }

 private:
  struct Seen {
    double time_s = 0;
    bool begins_shot = false;
  };
  using Kept = std::pair<std::int64_t, std::shared_ptr<const video::Frame>>;

  video::Reader open(std::int64_t first) const;
  void seek(std::int64_t k);
  // Keeps the reader's next frame; false at the end.
  bool read_on();
  void keep(std::int64_t k, std::shared_ptr<const video::Frame> frame);

  scene::Scene scene_;  // of the background alone
  pipeline::Options options_;
  std::optional<video::Reader> reader_;
  video::StreamInfo info_;
  double begin_s_ = 0;
  std::vector<double> times_s_;
  std::int64_t next_ = 0;        // that the reader gives
  std::int64_t first_sure_ = 0;  // from which on this reader knows the cuts
  std::optional<std::int64_t> first_pts_;
  std::optional<std::int64_t> end_;  // where it was found
  std::list<Kept> kept_;             // the last used first
  std::map<std::int64_t, std::list<Kept>::iterator> places_;
  std::size_t bytes_ = 0;
  std::map<std::int64_t, Seen> seen_;
  std::map<std::int64_t, insertion::Glance> glances_;
  image::ToneCurve tone_;
};

// Small pictures of a clip's frames, read beside it. Of one thread.
class Thumbnails {
 public:
  explicit Thumbnails(pipeline::Options options) : options_(std::move(options)) {}

  // Of about frame k, as JPEG. Throws Error where the clip cannot be read there.
  std::string at(const scene::Background& background, std::int64_t k, int width);

 private:
  pipeline::Options options_;
  std::string clip_;  // the background that `reader_` reads, as text
  std::optional<video::Reader> reader_;
  std::map<std::pair<std::int64_t, int>, std::string> made_;
};

}  // namespace airtruth::session
