// SPDX-License-Identifier: Apache-2.0
#include "picture/video/telemetry.h"

#include "foundation/base/error.h"
#include "picture/video/libav.h"

namespace airtruth::video {

std::vector<TelemetryPacket> read_telemetry(const std::filesystem::path& path) {
  keep_libav_quiet();
  AVFormatContext* opened = nullptr;
  if (!std::filesystem::is_regular_file(path)) return {};
  if (const int result = avformat_open_input(&opened, path.c_str(), nullptr, nullptr); result < 0)
    throw Error("cannot be opened as a video: " + reason(result), {path.string()});
  const InputPtr input(opened);
  avformat_find_stream_info(input.get(), nullptr);
  int telemetry = -1;
  double start_s = 0;
  for (unsigned i = 0; i < input->nb_streams; ++i) {
    const AVStream& stream = *input->streams[i];
    if (stream.codecpar->codec_tag == MKTAG('g', 'p', 'm', 'd')) telemetry = static_cast<int>(i);
    if (stream.codecpar->codec_type == AVMEDIA_TYPE_VIDEO && stream.start_time != AV_NOPTS_VALUE)
      start_s = static_cast<double>(stream.start_time) * av_q2d(stream.time_base);
  }
  if (telemetry < 0) return {};
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
