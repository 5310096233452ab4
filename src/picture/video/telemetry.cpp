// SPDX-License-Identifier: Apache-2.0
#include "picture/video/telemetry.h"

#include "foundation/base/error.h"
#include "picture/video/libav.h"

namespace airtruth::video {
namespace {

// The index of the last stream of telemetry; -1: none.
int telemetry_stream(const AVFormatContext& input) {
  int found = -1;
  for (unsigned i = 0; i < input.nb_streams; ++i)
    if (input.streams[i]->codecpar->codec_tag == MKTAG('g', 'p', 'm', 'd'))
      found = static_cast<int>(i);
  return found;
}

}  // namespace

std::vector<TelemetryPacket> read_telemetry(const std::filesystem::path& path) {
  keep_libav_quiet();
  AVFormatContext* opened = nullptr;
  if (!std::filesystem::is_regular_file(path)) return {};
  if (const int result = avformat_open_input(&opened, path.c_str(), nullptr, nullptr); result < 0)
    throw Error("cannot be opened as a video: " + reason(result), {path.string()});
  const InputPtr input(opened);
  // A file whose header lists all streams need not be decoded to know that it has no telemetry.
  const bool all_are_listed = (input->ctx_flags & AVFMTCTX_NOHEADER) == 0;
  if (all_are_listed && telemetry_stream(*input) < 0) return {};
  avformat_find_stream_info(input.get(), nullptr);
  const int telemetry = telemetry_stream(*input);
  if (telemetry < 0) return {};
  double start_s = 0;
  for (unsigned i = 0; i < input->nb_streams; ++i) {
    const AVStream& stream = *input->streams[i];
    if (stream.codecpar->codec_type == AVMEDIA_TYPE_VIDEO && stream.start_time != AV_NOPTS_VALUE)
      start_s = static_cast<double>(stream.start_time) * av_q2d(stream.time_base);
  }
  for (unsigned i = 0; i < input->nb_streams; ++i)
    if (static_cast<int>(i) != telemetry) input->streams[i]->discard = AVDISCARD_ALL;
  const double base = av_q2d(input->streams[telemetry]->time_base);
  std::vector<TelemetryPacket> packets;
  const PacketPtr packet(av_packet_alloc());
  while (av_read_frame(input.get(), packet.get()) >= 0) {
    if (packet->stream_index == telemetry && packet->size > 0 && packet->pts != AV_NOPTS_VALUE) {
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

}  // namespace airtruth::video
