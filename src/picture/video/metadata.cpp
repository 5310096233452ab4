// SPDX-License-Identifier: Apache-2.0
#include "picture/video/metadata.h"

#include "picture/video/libav.h"
#include "picture/video/media_file.h"
#include "picture/video/numbered_images.h"

namespace airtruth::video {
namespace {

// Empty where the path is no video file.
InputPtr opened_file(const std::filesystem::path& path) {
  if (!std::filesystem::is_regular_file(path) || numbered_images(path)) return nullptr;
  return open_media(path, Media::kAny);
}

// The index of the last stream of telemetry; -1: none.
int telemetry_stream(const AVFormatContext& input) {
  int found = -1;
  for (unsigned i = 0; i < input.nb_streams; ++i)
    if (input.streams[i]->codecpar->codec_tag == MKTAG('g', 'p', 'm', 'd'))
      found = static_cast<int>(i);
  return found;
}

// The index of the first stream of text; -1: none.
int subtitle_stream(const AVFormatContext& input) {
  for (unsigned i = 0; i < input.nb_streams; ++i) {
    const AVCodecID codec = input.streams[i]->codecpar->codec_id;
    if (codec == AV_CODEC_ID_MOV_TEXT || codec == AV_CODEC_ID_SUBRIP || codec == AV_CODEC_ID_TEXT)
      return static_cast<int>(i);
  }
  return -1;
}

// All packets of the stream that `stream_in` finds in a file, with times from the first frame.
std::vector<TelemetryPacket> packets_of(const std::filesystem::path& path,
                                        int (*stream_in)(const AVFormatContext&)) {
  const InputPtr input = opened_file(path);
  if (!input) return {};
  // A file whose header lists all streams need not be decoded to know that it has none.
  const bool all_are_listed = (input->ctx_flags & AVFMTCTX_NOHEADER) == 0;
  if (all_are_listed && stream_in(*input) < 0) return {};
  find_streams(*input);
  const int wanted = stream_in(*input);
  if (wanted < 0) return {};
  double start_s = 0;
  for (unsigned i = 0; i < input->nb_streams; ++i) {
    const AVStream& stream = *input->streams[i];
    if (stream.codecpar->codec_type == AVMEDIA_TYPE_VIDEO && stream.start_time != AV_NOPTS_VALUE)
      start_s = static_cast<double>(stream.start_time) * av_q2d(stream.time_base);
  }
  for (unsigned i = 0; i < input->nb_streams; ++i)
    if (static_cast<int>(i) != wanted) input->streams[i]->discard = AVDISCARD_ALL;
  const double base = av_q2d(input->streams[wanted]->time_base);
  std::vector<TelemetryPacket> packets;
  const PacketPtr packet(av_packet_alloc());
  while (av_read_frame(input.get(), packet.get()) >= 0) {
    if (packet->stream_index == wanted && packet->size > 0 && packet->pts != AV_NOPTS_VALUE) {
      TelemetryPacket one;
      one.begin_s = static_cast<double>(packet->pts) * base - start_s;
      one.end_s = one.begin_s + static_cast<double>(packet->duration) * base;
      one.bytes.assign(packet->data, packet->data + packet->size);
      packets.push_back(std::move(one));
    }
    av_packet_unref(packet.get());
  }
  return packets;
}

}  // namespace

std::map<std::string, std::string> read_tags(const std::filesystem::path& path) {
  const InputPtr input = opened_file(path);
  if (!input) return {};
  return tags_of(*input);
}

std::vector<TelemetryPacket> read_telemetry(const std::filesystem::path& path) {
  return packets_of(path, telemetry_stream);
}

std::vector<Subtitle> read_subtitles(const std::filesystem::path& path) {
  std::vector<Subtitle> subtitles;
  for (const TelemetryPacket& packet : packets_of(path, subtitle_stream)) {
    Subtitle& subtitle = subtitles.emplace_back();
    subtitle.begin_s = packet.begin_s;
    // mov_text begins with the length of the text in two bytes.
    const std::size_t first =
        packet.bytes.size() >= 2 && packet.bytes[0] < 0x20 && packet.bytes[0] != '\n' ? 2 : 0;
    subtitle.text.assign(packet.bytes.begin() + static_cast<std::ptrdiff_t>(first),
                         packet.bytes.end());
  }
  return subtitles;
}

}  // namespace airtruth::video
