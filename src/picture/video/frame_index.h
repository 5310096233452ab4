// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "picture/video/libav.h"

// Where the decoding of a frame can begin, found without decoding: from the packets of a file
// alone.
namespace airtruth::video {

// A packet from which a decoder can begin. Times are in units of the stream's clock.
struct KeyPacket {
  std::int64_t pts = 0;
  std::int64_t dts = 0;
};

// The times of a packet. Where pictures are decoded in the order in which they are shown, a
// container such as avi states one time. Empty where there is none.
std::optional<KeyPacket> times_of(const AVPacket& packet, const AVCodecParameters& codec);

struct FrameIndex {
  // When each frame is shown, in increasing order. The frames are those that the container shows:
  // packets outside an edit list are none.
  std::vector<std::int64_t> pts;
  // In the order of the file.
  std::vector<KeyPacket> keys;

  // The number of a frame; empty where none is shown at that time.
  std::optional<std::size_t> frame_at(std::int64_t time) const;
  // The last key packet that is shown at or before a frame, and the one `back` key packets before
  // it. Empty before the first.
  std::optional<KeyPacket> key_for(std::size_t frame, std::size_t back) const;
};

// The index of a video's first packets, up to the one after which frame `last` of those shown from
// `first_pts` on is known; frame 0 is the one shown at `first_pts`. Empty where packets hold no
// time stamps, two of them hold the same, or one is damaged.
std::optional<FrameIndex> index_frames(const std::filesystem::path& path,
                                       int stream_index,
                                       std::int64_t first_pts,
                                       std::int64_t last);

}  // namespace airtruth::video
