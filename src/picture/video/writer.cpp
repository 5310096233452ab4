// SPDX-License-Identifier: Apache-2.0
#include "picture/video/writer.h"

#include <algorithm>
#include <optional>

#include <fmt/format.h>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/base/names.h"
#include "foundation/base/unfinished.h"
#include "foundation/image/colour.h"
#include "picture/video/encoder.h"
#include "picture/video/libav.h"
#include "picture/video/media_file.h"
#include "picture/video/still.h"

namespace airtruth::video {
namespace {

using image::Colour;
using image::Picture;

struct FreeOutput {
  void operator()(AVFormatContext* p) const {
    if (p->pb != nullptr) avio_closep(&p->pb);
    avformat_free_context(p);
  }
};

}  // namespace

struct Writer::State {
  // An unfinished video leaves nothing behind.
  ~State() {
    if (!unfinished) return;
    output.reset();
    std::error_code ignored;
    fs::remove_all(part, ignored);
  }

  fs::path path;
  fs::path part;
  StreamInfo info;
  WriterOptions options;
  Colour stored;
  std::unique_ptr<AVFormatContext, FreeOutput> output;
  CodecPtr codec;
  std::string encoder_name = "png";
  AVStream* stream = nullptr;
  PacketPtr packet;
  std::int64_t count = 0;
  std::int64_t last_pts = -1;
  std::int64_t first_pts = 0;
  std::optional<Unfinished> unfinished;

  [[noreturn]] void fail(const std::string& message) const {
    throw Error(message, {path.string()});
  }
  void check_av(int result, const char* what) const {
    if (result < 0) fail(std::string(what) + ": " + reason(result));
  }

  void open() {
    keep_libav_quiet();
    const char* muxer = options.format == Format::kMp4   ? "mp4"
                        : options.format == Format::kMkv ? "matroska"
                                                         : "avi";
    const std::string url = file_url(part);
    AVFormatContext* raw = nullptr;
    check_av(avformat_alloc_output_context2(&raw, nullptr, muxer, url.c_str()), "cannot create");
    output.reset(raw);
    output->flags |= AVFMT_FLAG_BITEXACT;
    const bool has_global_header = (output->oformat->flags & AVFMT_GLOBALHEADER) != 0;
    codec = open_encoder({info, stored, has_global_header}, options, path);
    encoder_name = codec->codec->name;
    stream = avformat_new_stream(output.get(), nullptr);
    check(stream != nullptr, "a stream can be made");
    check_av(avcodec_parameters_from_context(stream->codecpar, codec.get()),
             "cannot describe the stream");
    stream->time_base = codec->time_base;
    stream->avg_frame_rate = codec->framerate;
    stream->sample_aspect_ratio = codec->sample_aspect_ratio;
    if (const int opened = avio_open(&output->pb, url.c_str(), AVIO_FLAG_WRITE); opened < 0)
      fail("cannot create: " + reason(opened));
    AVDictionary* settings = nullptr;
    if (options.format == Format::kMp4) av_dict_set(&settings, "movflags", "+faststart", 0);
    const int written = avformat_write_header(output.get(), &settings);
    av_dict_free(&settings);
    check_av(written, "cannot write");
    packet.reset(av_packet_alloc());
  }

  void encode(const AVFrame* frame) {
    check_av(avcodec_send_frame(codec.get(), frame), "cannot encode");
    for (;;) {
      const int got = avcodec_receive_packet(codec.get(), packet.get());
      if (got == AVERROR(EAGAIN) || got == AVERROR_EOF) return;
      check_av(got, "cannot encode");
      av_packet_rescale_ts(packet.get(), codec->time_base, stream->time_base);
      packet->stream_index = stream->index;
      const int written = av_interleaved_write_frame(output.get(), packet.get());
      check_av(written, "cannot write");
      if (output->pb->error < 0) fail("cannot write: " + reason(output->pb->error));
    }
  }

  void write_image(const Picture& picture) const {
    write_still(part / fmt::format("{:06}.png", count), image::rgb8_from_picture(picture));
  }
};

Writer::Writer(const fs::path& path, const StreamInfo& info, const WriterOptions& options)
    : state_(std::make_unique<State>()) {
  if (options.quality < 0 || options.quality > 51)
    throw Error("quality is " + std::to_string(options.quality) + "; expected 0 (best) to 51",
                {path.string()});
  state_->path = path;
  state_->part = part_path(path);
  state_->info = info;
  state_->options = options;
  state_->stored = stored_colour(info, options.format, path);
  state_->unfinished.emplace(Unfinished::path(state_->part));
  if (options.format != Format::kPng) {
    state_->open();
    return;
  }
  std::error_code failed;
  if (fs::exists(path) && !(fs::is_directory(path) && fs::is_empty(path)))
    state_->fail("exists already; expected the name of a new folder for the images");
  fs::remove_all(state_->part, failed);
  fs::create_directories(state_->part, failed);
  if (failed) state_->fail("cannot create: " + failed.message());
}

Writer::~Writer() = default;

void Writer::write(const Frame& frame) {
  State& s = *state_;
  check(frame.picture.width == s.info.width && frame.picture.height == s.info.height,
        "frames keep their size");
  if (s.options.format == Format::kPng) {
    s.write_image(frame.picture);
    ++s.count;
    return;
  }
  const FramePtr out = copied_frame(*s.codec, frame.picture, s.stored, s.options.format);
  if (s.count == 0) s.first_pts = frame.pts;
  std::int64_t pts = s.options.format == Format::kAvi ? s.count : frame.pts - s.first_pts;
  if (pts <= s.last_pts) pts = s.last_pts + 1;
  s.last_pts = pts;
  out->pts = pts;
  out->quality = s.codec->global_quality;
  s.encode(out.get());
  ++s.count;
}

const std::string& Writer::encoder() const { return state_->encoder_name; }

void Writer::finish() {
  State& s = *state_;
  if (s.options.format != Format::kPng) {
    s.encode(nullptr);
    s.check_av(av_write_trailer(s.output.get()), "cannot write");
    avio_flush(s.output->pb);
    if (s.output->pb->error < 0) s.fail("cannot write: " + reason(s.output->pb->error));
    if (const int closed = avio_closep(&s.output->pb); closed < 0)
      s.fail("cannot write: " + reason(closed));
    // The encoder's memory, some 100 MB at 1280x960, is free for what follows.
    s.codec.reset();
    s.output.reset();
  }
  s.unfinished->finish([&s] {
    std::error_code failed;
    if (s.options.format == Format::kPng && fs::exists(s.path))
      // The folder is empty at this point.
      fs::remove(s.path, failed);
    fs::rename(s.part, s.path, failed);
    if (failed) s.fail("cannot create: " + failed.message());
  });
  s.unfinished.reset();
}

Format format_of_file(const fs::path& path) {
  const std::string ending = path.extension().string();
  for (const Format format : {Format::kMp4, Format::kMkv, Format::kAvi})
    if (ending == extension(format)) return format;
  throw Error("has " + (ending.empty() ? "no ending" : "the ending " + ending) +
                  "; expected .mp4, .mkv or .avi",
              {path.string()});
}

const char* extension(Format format) {
  return format == Format::kMp4   ? ".mp4"
         : format == Format::kMkv ? ".mkv"
         : format == Format::kAvi ? ".avi"
                                  : "";
}

}  // namespace airtruth::video
