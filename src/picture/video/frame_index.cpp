// SPDX-License-Identifier: Apache-2.0
#include "picture/video/frame_index.h"

#include <algorithm>

#include "picture/video/media_file.h"

namespace airtruth::video {
namespace {

// Packets whose pictures are shown later than those of packets after them are at most this many
// apart: 16 reference pictures of H.264 and HEVC.
constexpr std::int64_t kMaxReordered = 16;

}  // namespace

std::optional<KeyPacket> times_of(const AVPacket& packet, const AVCodecParameters& codec) {
  const bool in_order = codec.video_delay == 0;
  const std::int64_t pts = packet.pts == AV_NOPTS_VALUE && in_order ? packet.dts : packet.pts;
  if (pts == AV_NOPTS_VALUE) return std::nullopt;
  return KeyPacket{pts, packet.dts == AV_NOPTS_VALUE ? pts : packet.dts};
}

std::optional<std::size_t> FrameIndex::frame_at(std::int64_t time) const {
  const auto found = std::lower_bound(pts.begin(), pts.end(), time);
  if (found == pts.end() || *found != time) return std::nullopt;
  return static_cast<std::size_t>(found - pts.begin());
}

std::optional<KeyPacket> FrameIndex::key_for(std::size_t frame, std::size_t back) const {
  const auto after = std::find_if(
      keys.begin(), keys.end(), [&](const KeyPacket& key) { return key.pts > pts[frame]; });
  const auto before = static_cast<std::size_t>(after - keys.begin());
  if (before <= back) return std::nullopt;
  return keys[before - 1 - back];
}

std::optional<FrameIndex> index_frames(const std::filesystem::path& path,
                                       int stream_index,
                                       std::int64_t first_pts,
                                       std::int64_t last) {
  const InputPtr input = open_media(path, Media::kAny);
  if (find_streams(*input) < 0 || stream_index >= static_cast<int>(input->nb_streams))
    return std::nullopt;
  for (unsigned i = 0; i < input->nb_streams; ++i)
    if (static_cast<int>(i) != stream_index) input->streams[i]->discard = AVDISCARD_ALL;
  const AVCodecParameters& codec = *input->streams[stream_index]->codecpar;
  FrameIndex index;
  const PacketPtr packet(av_packet_alloc());
  while (std::ssize(index.pts) <= last + kMaxReordered &&
         av_read_frame(input.get(), packet.get()) >= 0) {
    if (packet->stream_index == stream_index) {
      const auto times = times_of(*packet, codec);
      if (!times || (packet->flags & AV_PKT_FLAG_CORRUPT) != 0) return std::nullopt;
      if ((packet->flags & AV_PKT_FLAG_KEY) != 0) index.keys.push_back(*times);
      if ((packet->flags & AV_PKT_FLAG_DISCARD) == 0 && times->pts >= first_pts)
        index.pts.push_back(times->pts);
    }
    av_packet_unref(packet.get());
  }
  std::sort(index.pts.begin(), index.pts.end());
  const bool is_strict = std::adjacent_find(index.pts.begin(), index.pts.end()) == index.pts.end();
  if (!is_strict || index.pts.empty() || index.pts.front() != first_pts) return std::nullopt;
  return index;
}

}  // namespace airtruth::video
