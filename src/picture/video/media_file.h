// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "picture/video/libav.h"

// The one place where media files are opened for reading. libav can read hundreds of formats, among
// them lists of other files, addresses of the network, texts and vector drawings. Here it reaches
// the containers and codecs of cameras alone, and no file but the one that is named.
namespace airtruth::video {

// libav's names of the containers of video and of the picture formats, and of the decoders.
std::span<const char* const> readable_containers();
std::span<const char* const> readable_codecs();

// The largest picture, in pixels: 8192 x 8192. 8K has 33 million. A frame takes some 30 bytes a
// pixel in a render.
constexpr std::int64_t kMaxPixels = std::int64_t{1} << 26;
// The longest side, in pixels. JPEG, PNG and H.264 have room for it.
constexpr int kMaxSidePx = 16384;

// The file's address in libav's terms. A path has no special meaning in it, whatever its colons and
// percent signs.
std::string file_url(const std::filesystem::path& path);

enum class Media {
  kAny,            // a container of video, or one picture
  kNumberedImage,  // a picture whose format is that of the name's ending, and a rate
};

// Opens a regular file. `rate` is the frame rate of numbered images, empty for libav's own. Throws
// Error where the file cannot be read, or is no container of the list.
InputPtr open_media(const std::filesystem::path& path, Media media, const std::string& rate = {});

// The tags of the file and of its video stream, with keys in lower case; a stream's takes
// precedence.
std::map<std::string, std::string> tags_of(const AVFormatContext& input);

// Looks at packets until the properties of all streams are known. Returns libav's error, or 0 or
// more.
int find_streams(AVFormatContext& input);

// An unopened decoder of the stream, limited to kMaxPixels. Throws Error at `path` where its codec
// is not in the list or its picture is too large.
CodecPtr decoder_of(const AVStream& stream, const std::filesystem::path& path);

// Throws Error at `path` where a picture of that size is larger than the limits.
void check_picture_size(int width, int height, const std::filesystem::path& path);

// Packets whose pictures are shown later than those of packets after them are at most this many
// apart: 16 reference pictures of H.264 and HEVC.
constexpr std::int64_t kMaxReordered = 16;

// Where the decoding of a frame can begin, found without decoding: from the packets of a file.

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
// time stamps, two of them hold the same, the stamps begin anew, or a packet is damaged.
std::optional<FrameIndex> index_frames(const std::filesystem::path& path,
                                       int stream_index,
                                       std::int64_t first_pts,
                                       std::int64_t last);

}  // namespace airtruth::video
