// SPDX-License-Identifier: Apache-2.0
#include "picture/video/media_file.h"

#include <algorithm>
#include <array>
#include <functional>
#include <string_view>

#include <fmt/format.h>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/base/names.h"

namespace airtruth::video {
namespace {

constexpr std::array kContainers = {
    "mov",      "matroska",     "avi",       "mpegts",   "mpeg",      "mxf",
    "ogg",      "flv",          "ivf",       "dv",       "h264",      "hevc",
    "m4v",      "yuv4mpegpipe", "png_pipe",  "bmp_pipe", "jpeg_pipe", "pgm_pipe",
    "ppm_pipe", "tiff_pipe",    "webp_pipe", "image2"};

constexpr std::array kCodecs = {
    "h264",       "hevc",       "libdav1d", "libaom-av1", "vp8",     "vp9",      "mpeg4",
    "mpeg2video", "mpeg1video", "mjpeg",    "prores",     "dnxhd",   "cfhd",     "dvvideo",
    "theora",     "ffv1",       "huffyuv",  "ffvhuff",    "utvideo", "magicyuv", "rawvideo",
    "v210",       "png",        "bmp",      "pgm",        "ppm",     "tiff",     "webp"};

// libav's names of one demuxer are separated by commas: "mov,mp4,m4a,3gp,3g2,mj2".
bool is_listed(std::string_view name, std::span<const char* const> list) {
  const std::string_view first = name.substr(0, name.find(','));
  return std::find(list.begin(), list.end(), first) != list.end();
}

std::string joined(std::span<const char* const> list) {
  return fmt::format("{}", fmt::join(list, ","));
}

// The container of the file's bytes; never a guess from its name.
const AVInputFormat* container_of(const std::string& url, const fs::path& path) {
  Settings settings;
  av_dict_set(&settings.entries, "protocol_whitelist", "file", 0);
  AVIOContext* raw = nullptr;
  int result = avio_open2(&raw, url.c_str(), AVIO_FLAG_READ, nullptr, &settings.entries);
  const std::unique_ptr<AVIOContext, Free<avio_closep>> io(raw);
  const AVInputFormat* found = nullptr;
  if (result >= 0) result = av_probe_input_buffer2(io.get(), &found, "", nullptr, 0, 0);
  if (result < 0) throw Error("cannot be read as a video: " + reason(result), {path.string()});
  if (!is_listed(found->name, kContainers))
    throw Error(fmt::format("is a file of the kind '{}'; expected a video (mp4, mov, mkv, webm, "
                            "avi, ts, mpg, ...) or a picture (png, jpg, bmp, tif, ppm, webp)",
                            found->name),
                {path.string()});
  return found;
}

void add_tags(const AVDictionary* tags, std::map<std::string, std::string>& result) {
  const AVDictionaryEntry* entry = nullptr;
  while ((entry = av_dict_get(tags, "", entry, AV_DICT_IGNORE_SUFFIX)) != nullptr) {
    result[lower_case(entry->key)] = entry->value;
  }
}

}  // namespace

std::span<const char* const> readable_containers() { return kContainers; }
std::span<const char* const> readable_codecs() { return kCodecs; }

std::string file_url(const fs::path& path) { return "file:" + path.string(); }

InputPtr open_media(const fs::path& path, Media media, const std::string& rate) {
  keep_libav_quiet();
  const std::string url = file_url(path);
  const AVInputFormat* format =
      media == Media::kAny ? container_of(url, path) : av_find_input_format("image2");
  Settings settings;
  av_dict_set(&settings.entries, "protocol_whitelist", "file", 0);
  av_dict_set(&settings.entries, "format_whitelist", joined(kContainers).c_str(), 0);
  av_dict_set(&settings.entries, "codec_whitelist", joined(kCodecs).c_str(), 0);
  // A % in the name of a picture or folder is an ordinary character. Videos ignore the setting.
  av_dict_set(&settings.entries, "pattern_type", "none", 0);
  if (!rate.empty()) av_dict_set(&settings.entries, "framerate", rate.c_str(), 0);
  AVFormatContext* raw = nullptr;
  const int opened = avformat_open_input(&raw, url.c_str(), format, &settings.entries);
  if (opened < 0) throw Error("cannot be read as a video: " + reason(opened), {path.string()});
  return InputPtr(raw);
}

std::map<std::string, std::string> tags_of(const AVFormatContext& input) {
  std::map<std::string, std::string> result;
  add_tags(input.metadata, result);
  for (unsigned i = 0; i < input.nb_streams; ++i)
    if (input.streams[i]->codecpar->codec_type == AVMEDIA_TYPE_VIDEO)
      add_tags(input.streams[i]->metadata, result);
  return result;
}

int find_streams(AVFormatContext& input) {
  std::vector<AVDictionary*> of_each(input.nb_streams);
  for (AVDictionary*& one : of_each) av_dict_set_int(&one, "max_pixels", kMaxPixels, 0);
  const int found = avformat_find_stream_info(&input, of_each.data());
  for (AVDictionary*& one : of_each) av_dict_free(&one);
  return found;
}

CodecPtr decoder_of(const AVStream& stream, const fs::path& path) {
  const AVCodec* decoder = avcodec_find_decoder(stream.codecpar->codec_id);
  if (decoder == nullptr || !is_listed(decoder->name, kCodecs))
    throw Error(fmt::format("is {}, which is not decoded; expected H.264, HEVC, AV1, VP9, MPEG-4, "
                            "MJPEG, ProRes, FFV1 or another codec of cameras (convert it: ffmpeg "
                            "-i IN OUT.mp4)",
                            avcodec_get_name(stream.codecpar->codec_id)),
                {path.string()});
  check_picture_size(stream.codecpar->width, stream.codecpar->height, path);
  CodecPtr codec(avcodec_alloc_context3(decoder));
  if (!codec) throw std::bad_alloc();
  avcodec_parameters_to_context(codec.get(), stream.codecpar);
  codec->pkt_timebase = stream.time_base;
  codec->max_pixels = kMaxPixels;
  return codec;
}

void check_picture_size(int width, int height, const fs::path& path) {
  if (std::int64_t{width} * height <= kMaxPixels && std::max(width, height) <= kMaxSidePx) return;
  throw Error(fmt::format("has pictures of {}x{} px; expected at most {} px a side and {} million "
                          "px in all",
                          width,
                          height,
                          kMaxSidePx,
                          kMaxPixels / 1'000'000),
              {path.string()});
}

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
  const bool begins_anew =
      std::ranges::adjacent_find(index.keys, std::ranges::greater_equal{}, &KeyPacket::pts) !=
      index.keys.end();
  if (!is_strict || begins_anew || index.pts.empty() || index.pts.front() != first_pts)
    return std::nullopt;
  return index;
}

}  // namespace airtruth::video
