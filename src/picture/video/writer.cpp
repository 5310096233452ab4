// SPDX-License-Identifier: Apache-2.0
#include "picture/video/writer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <new>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "foundation/base/files.h"
#include "foundation/base/unfinished.h"
#include "foundation/image/colour.h"
#include "picture/video/libav.h"
#include "picture/video/media_file.h"
#include "picture/video/still.h"

namespace airtruth::video {
namespace {

using image::Chroma;
using image::Colour;
using image::Matrix;
using image::Picture;
using image::Range;

// Converts from limited to full range (JPEG) and changes nothing else: each plane has its own
// linear map.
Picture with_full_range(const Picture& picture, const Colour& to) {
  Picture result = image::make_picture(picture.width, picture.height, to);
  for (std::size_t i = 0; i < static_cast<std::size_t>(result.plane_count); ++i) {
    for (int y = 0; y < result.planes[i].height; ++y) {
      std::uint8_t* target = result.planes[i].row(y);
      if (i > 0 && picture.plane_count == 1) {
        std::memset(target, 128, static_cast<std::size_t>(result.planes[i].width));
        continue;
      }
      const std::uint8_t* source = picture.planes[i].row(y);
      for (int x = 0; x < result.planes[i].width; ++x) {
        const double value =
            i == 0 ? (source[x] - 16) * 255.0 / 219 : (source[x] - 128) * 255.0 / 224 + 128;
        target[x] = static_cast<std::uint8_t>(std::clamp(std::lround(value), 0L, 255L));
      }
    }
  }
  return result;
}

// The picture's samples in a pixel format, whose planes are the picture's own or are packed.
FramePtr planes_as(const Picture& picture, AVPixelFormat format) {
  const AVPixelFormat planar = format == AV_PIX_FMT_BGR0   ? AV_PIX_FMT_GBRP
                               : format == AV_PIX_FMT_NV12 ? AV_PIX_FMT_YUV420P
                                                           : format;
  FramePtr frame = new_frame(planar, picture.width, picture.height);
  copy_planes(picture, *frame);
  return planar == format ? std::move(frame) : in_format(*frame, format);
}

// H.264 halves chroma in whole samples. libx264 also refuses such a size, but leaks memory when it
// does.
void check_size(const StreamInfo& info, Chroma chroma, Format format, const Where& where) {
  const bool half_width = chroma == Chroma::k420 || chroma == Chroma::k422;
  const bool half_height = chroma == Chroma::k420;
  if (format != Format::kMp4 ||
      ((!half_width || info.width % 2 == 0) && (!half_height || info.height % 2 == 0)))
    return;
  throw Error("H.264 cannot hold " + std::to_string(info.width) + "x" +
                  std::to_string(info.height) +
                  " with halved chroma (an odd size); expected mkv or avi, or of a scene's "
                  "output.video png",
              where);
}

[[noreturn]] void refuse_rate(const std::string& found, const Where& where) {
  throw Error(
      "avi cannot hold the times of a variable frame rate" + found + "; expected mp4 or mkv",
      where);
}

// AVI states one rate and no times.
void check_rate(const StreamInfo& info, Format format, const Where& where) {
  if (format == Format::kAvi && info.variable_frame_rate) refuse_rate("", where);
}

// Throws Error where the time of a frame of AVI would differ from its own by more than one frame,
// as where a single frame is missing, and what the rounding of two time stamps adds. Stamps of
// whole milliseconds also have their camera's jitter.
void check_time(std::int64_t count, std::int64_t pts, const StreamInfo& info, const Where& where) {
  constexpr double kCoarseStamp = 0.01;  // of a frame
  constexpr double kJitter = 0.5;        // of a frame
  const double stamp = info.time_base.value() * info.frame_rate.value();
  const double most = 1 + (stamp < kCoarseStamp ? stamp : kJitter);
  const double late = static_cast<double>(pts) * stamp - static_cast<double>(count);
  if (std::abs(late) <= most) return;
  refuse_rate(fmt::format(" (frame {} is {:.1f} frames {} than at {:.6g} frames/s)",
                          count,
                          std::abs(late),
                          late > 0 ? "later" : "earlier",
                          info.frame_rate.value()),
              where);
}

AVPixelFormat pixel_format(const Colour& colour, Format format) {
  if (colour.matrix == Matrix::kRgb) return AV_PIX_FMT_BGR0;
  return planar_format(colour.chroma, format == Format::kAvi);
}

using BufferPtr = std::unique_ptr<AVBufferRef, Free<av_buffer_unref>>;

// What each encoder of H.264 is called in libav, and the pixel format that it takes from memory.
struct H264Encoder {
  Encoder encoder;
  const char* name;
  AVPixelFormat pixel_format;
};
// In the order in which Encoder::kAuto tries them.
constexpr std::array<H264Encoder, 3> kHardware = {
    {{Encoder::kNvenc, "h264_nvenc", AV_PIX_FMT_YUV420P},
     {Encoder::kVaapi, "h264_vaapi", AV_PIX_FMT_VAAPI},
     {Encoder::kQsv, "h264_qsv", AV_PIX_FMT_NV12}}};

// Number of frames that libx264 encodes at a time, one on each thread. It is a constant because the
// bytes depend on it: a frame's motion search ends at the rows of its reference that are ready, and
// the rate control does not yet know the frames that other threads are at. Eight keep eight cores
// at work; on two cores they take as much CPU time as two threads do, and 12 MiB each at 1280x960.
constexpr int kX264Threads = 8;

// libx264's settings: those of its preset "veryfast", but that P and B pictures predict whole
// macroblocks alone, that at most one B picture stands between two others, and that the motion
// search is a diamond. Onboard video then has the same quality at the same size for a fifth to a
// third less of the encoder's time (docs/decisions/0055-x264-for-onboard-video.md).
//
// cpu-independent gives the same bytes on every machine. Without it x264's fastest code (AVX-512,
// mbtree) even gives different bytes from one encode to the next in the same process.
constexpr const char* kX264Preset = "veryfast";
constexpr const char* kX264Settings = "partitions=i8x8,i4x4:bframes=1:me=dia:cpu-independent=1";

// What an encoder must know of the video.
struct EncoderInput {
  StreamInfo info;
  image::Colour stored;  // stored_colour()
  // True where the container keeps the codec's header apart from the packets.
  bool has_global_header = false;
};

struct Opened {
  CodecPtr codec;
  std::string fault;  // why `codec` is null
};

void describe(AVCodecContext& codec, const EncoderInput& input, const WriterOptions& options) {
  const StreamInfo& info = input.info;
  codec.width = info.width;
  codec.height = info.height;
  codec.time_base = {info.time_base.num, info.time_base.den};
  codec.framerate = {info.frame_rate.num, info.frame_rate.den};
  if (options.format == Format::kAvi) codec.time_base = {info.frame_rate.den, info.frame_rate.num};
  codec.sample_aspect_ratio = {info.sample_aspect.num, info.sample_aspect.den};
  codec.color_range = input.stored.range == Range::kFull ? AVCOL_RANGE_JPEG : AVCOL_RANGE_MPEG;
  codec.colorspace = space_of(input.stored.matrix);
  codec.color_primaries = static_cast<AVColorPrimaries>(info.primaries_tag);
  codec.color_trc = static_cast<AVColorTransferCharacteristic>(info.transfer_tag);
  codec.chroma_sample_location = input.stored.siting == image::Siting::kCenter ? AVCHROMA_LOC_CENTER
                                 : input.stored.siting == image::Siting::kTopLeft
                                     ? AVCHROMA_LOC_TOPLEFT
                                     : AVCHROMA_LOC_LEFT;
  if (options.format == Format::kMp4)
    codec.gop_size =
        static_cast<int>(std::max(1L, std::lround(options.keyframe_s * info.frame_rate.value())));
  codec.thread_count = options.format == Format::kMp4 ? kX264Threads : std::max(0, options.threads);
  codec.flags |= AV_CODEC_FLAG_BITEXACT;
  if (input.has_global_header) codec.flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
}

// The encoder that `make_ready` completes, opened with the settings.
template <typename MakeReady>
Opened opened(const char* name,
              const EncoderInput& input,
              const WriterOptions& options,
              const MakeReady& make_ready) {
  const AVCodec* encoder = avcodec_find_encoder_by_name(name);
  if (encoder == nullptr) return {nullptr, "is missing from this FFmpeg"};
  CodecPtr codec(avcodec_alloc_context3(encoder));
  describe(*codec, input, options);
  Settings settings;
  int result = make_ready(*codec, &settings.entries);
  if (result >= 0) result = avcodec_open2(codec.get(), encoder, &settings.entries);
  if (result < 0) return {nullptr, "cannot be opened: " + reason(result)};
  return {std::move(codec), ""};
}

Opened open_own(const EncoderInput& input, const WriterOptions& options, const char* name) {
  return opened(name, input, options, [&](AVCodecContext& codec, AVDictionary** settings) {
    codec.pix_fmt = pixel_format(input.stored, options.format);
    if (options.format == Format::kMp4) {
      av_dict_set(settings, "preset", kX264Preset, 0);
      av_dict_set_int(settings, "crf", options.quality, 0);
      av_dict_set(settings, "x264-params", kX264Settings, 0);
    } else if (options.format == Format::kMkv) {
      av_dict_set_int(settings, "level", 3, 0);
      av_dict_set_int(settings, "slicecrc", 1, 0);
    } else {
      codec.flags |= AV_CODEC_FLAG_QSCALE;
      codec.global_quality = FF_QP2LAMBDA * std::clamp(1 + options.quality / 6, 1, 31);
    }
    return 0;
  });
}

// VAAPI takes frames in the memory of its device alone. Returns libav's error, or 0.
int add_device_frames(AVCodecContext& codec) {
  AVBufferRef* raw = nullptr;
  if (const int made = av_hwdevice_ctx_create(&raw, AV_HWDEVICE_TYPE_VAAPI, nullptr, nullptr, 0);
      made < 0)
    return made;
  const BufferPtr device(raw);
  BufferPtr frames(av_hwframe_ctx_alloc(device.get()));
  if (!frames) return AVERROR(ENOMEM);
  auto* context = reinterpret_cast<AVHWFramesContext*>(frames->data);
  context->format = AV_PIX_FMT_VAAPI;
  context->sw_format = AV_PIX_FMT_NV12;
  context->width = codec.width;
  context->height = codec.height;
  if (const int made = av_hwframe_ctx_init(frames.get()); made < 0) return made;
  codec.hw_frames_ctx = frames.release();
  return 0;
}

// The same quality scale as x264's: a constant quantiser of H.264 where the encoder has one.
Opened open_hardware(const H264Encoder& which,
                     const EncoderInput& input,
                     const WriterOptions& options) {
  if (input.stored.chroma != image::Chroma::k420) return {nullptr, "takes 4:2:0 alone"};
  return opened(which.name, input, options, [&](AVCodecContext& codec, AVDictionary** settings) {
    codec.pix_fmt = which.pixel_format;
    if (which.encoder == Encoder::kQsv) {
      codec.global_quality = std::max(1, options.quality);
      return 0;
    }
    av_dict_set_int(settings, "qp", options.quality, 0);
    if (which.encoder == Encoder::kNvenc) {
      av_dict_set(settings, "rc", "constqp", 0);
      return 0;
    }
    av_dict_set(settings, "rc_mode", "CQP", 0);
    return add_device_frames(codec);
  });
}

Opened open_h264(const EncoderInput& input, const WriterOptions& options) {
  for (const H264Encoder& which : kHardware) {
    if (options.encoder != which.encoder && options.encoder != Encoder::kAuto) continue;
    Opened hardware = open_hardware(which, input, options);
    if (hardware.codec) return hardware;
    if (options.encoder != which.encoder) continue;
    throw Error(std::string("encoder ") + which.name + " " + hardware.fault +
                    "; expected a machine that has it, or \"x264\" or \"auto\"",
                options.encoder_where);
  }
  return open_own(input, options, "libx264");
}

// The frame in the memory of the encoder's device.
FramePtr on_device(const AVCodecContext& encoder, const AVFrame& frame) {
  FramePtr result(av_frame_alloc());
  if (!result) throw std::bad_alloc();
  int done = av_hwframe_get_buffer(encoder.hw_frames_ctx, result.get(), 0);
  if (done >= 0) done = av_hwframe_transfer_data(result.get(), &frame, 0);
  if (done < 0) throw Error("the encoder's device takes no frame: " + reason(done));
  return result;
}

// The colour that a format stores for the video's pictures. Throws Error where it can hold none of
// their colour and size.
Colour stored_colour(const StreamInfo& info, Format format, const Where& where) {
  Colour stored = info.colour;
  if (format == Format::kMkv || format == Format::kPng) return stored;
  if (stored.matrix == Matrix::kRgb)
    stored = {Chroma::k444, Matrix::kBt709, Range::kFull, image::Siting::kCenter};
  if (format == Format::kAvi) {
    // JPEG supports no other matrix and range, and AVI states none.
    stored.matrix = Matrix::kBt601;
    stored.range = Range::kFull;
    if (stored.chroma == Chroma::kNone) stored.chroma = Chroma::k420;
  }
  if (stored.chroma == Chroma::k440)
    throw Error("mp4 and avi cannot hold 4:4:0; expected mkv, or of a scene's output.video png",
                where);
  check_size(info, stored.chroma, format, where);
  return stored;
}

// An open encoder: libx264 or what WriterOptions::encoder says for mp4, FFV1 for mkv, MJPEG for
// avi. Throws Error at `path`, or at WriterOptions::encoder_where where the named encoder of H.264
// cannot be opened on this machine.
CodecPtr open_encoder(const EncoderInput& input,
                      const WriterOptions& options,
                      const std::filesystem::path& path) {
  Opened result = options.format == Format::kMp4   ? open_h264(input, options)
                  : options.format == Format::kMkv ? open_own(input, options, "ffv1")
                                                   : open_own(input, options, "mjpeg");
  if (!result.codec) throw Error("cannot be written: its encoder " + result.fault, {path.string()});
  return std::move(result.codec);
}

// A copy of the picture for the encoder, converted to the colour `stored`; in the memory of the
// encoder's device where it has one. Throws std::bad_alloc, and Error where the device takes no
// frame.
FramePtr copied_frame(const AVCodecContext& encoder,
                      const image::Picture& picture,
                      const image::Colour& stored,
                      Format format) {
  const bool is_on_device = encoder.hw_frames_ctx != nullptr;
  const AVPixelFormat pixels = is_on_device ? AV_PIX_FMT_NV12 : encoder.pix_fmt;
  const Colour& colour = picture.colour;
  const bool keeps_matrix = colour.chroma == Chroma::kNone || colour.matrix == stored.matrix;
  FramePtr frame;
  if (keeps_matrix && format == Format::kAvi && colour.range == Range::kLimited)
    frame = planes_as(with_full_range(picture, stored), pixels);
  else if (keeps_matrix && stored.chroma == colour.chroma)
    frame = planes_as(picture, pixels);
  else  // through packed sRGB, as the format cannot store the picture's own colour
    frame = planes_as(image::picture_from_rgb8(image::rgb8_from_picture(picture), stored), pixels);
  if (is_on_device) frame = on_device(encoder, *frame);
  frame->color_range = encoder.color_range;
  frame->colorspace = encoder.colorspace;
  return frame;
}

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
    Settings settings;
    if (options.format == Format::kMp4) av_dict_set(&settings.entries, "movflags", "+faststart", 0);
    check_av(avformat_write_header(output.get(), &settings.entries), "cannot write");
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
  state_->stored = stored_colour(info, options.format, {path.string()});
  check_rate(info, options.format, {path.string()});
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
  if (s.count == 0) s.first_pts = frame.pts;
  if (s.options.format == Format::kAvi)
    check_time(s.count, frame.pts - s.first_pts, s.info, {s.path.string()});
  const FramePtr out = copied_frame(*s.codec, frame.picture, s.stored, s.options.format);
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

void check_output(const StreamInfo& info, Format format, const Where& where) {
  stored_colour(info, format, where);
  check_rate(info, format, where);
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
