// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

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

// Looks at packets until the properties of all streams are known. Returns libav's error, or 0 or
// more.
int find_streams(AVFormatContext& input);

// An unopened decoder of the stream, limited to kMaxPixels. Throws Error at `path` where its codec
// is not in the list or its picture is too large.
CodecPtr decoder_of(const AVStream& stream, const std::filesystem::path& path);

// Throws Error at `path` where a picture of that size is larger than the limits.
void check_picture_size(int width, int height, const std::filesystem::path& path);

}  // namespace airtruth::video
