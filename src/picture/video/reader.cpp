// SPDX-License-Identifier: Apache-2.0
#include "picture/video/reader.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <deque>
#include <set>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "foundation/base/files.h"
#include "foundation/base/in_parallel.h"
#include "foundation/image/cuts.h"
#include "picture/video/libav.h"
#include "picture/video/media_file.h"
#include "picture/video/numbered_images.h"

namespace airtruth::video {
namespace {

Rational rational(AVRational r) { return {r.num, r.den == 0 ? 1 : r.den}; }

image::Siting siting_of(AVChromaLocation location) {
  return location == AVCHROMA_LOC_CENTER    ? image::Siting::kCenter
         : location == AVCHROMA_LOC_TOPLEFT ? image::Siting::kTopLeft
                                            : image::Siting::kLeft;
}

// Largest numerator and denominator of a stated frame rate: 30000/1001 is exact.
constexpr int kMaxRateTerm = 100'000;

// The number of frames of a stream as its container states it, without those that an edit list
// leaves out; 0: unknown.
std::int64_t shown_frames(const AVStream& stream) {
  if (stream.nb_frames <= 0 || stream.duration <= 0 || stream.avg_frame_rate.num <= 0)
    return stream.nb_frames;
  const double shown = static_cast<double>(stream.duration) * av_q2d(stream.time_base) *
                       av_q2d(stream.avg_frame_rate);
  return std::min<std::int64_t>(stream.nb_frames, std::llround(shown));
}

// libav names its readers of a single picture png_pipe, bmp_pipe and so on. Their stream is there
// without a look at its packets.
bool is_picture_file(const AVFormatContext& input) {
  return std::string_view(input.iformat->name).ends_with("_pipe") && input.nb_streams == 1;
}

bool is_flawed(const AVFrame& frame) {
  return frame.decode_error_flags != 0 || (frame.flags & AV_FRAME_FLAG_CORRUPT) != 0;
}

// Passes each text on once, though what it is about may be read anew.
Warn once(Warn warn) {
  return [warn = std::move(warn),
          told = std::make_shared<std::set<std::string>>()](const std::string& text) {
    if (told->insert(text).second) airtruth::warn(warn, text);
  };
}

std::optional<double> quantiser_of(const AVFrame& frame) {
  const AVFrameSideData* data = av_frame_get_side_data(&frame, AV_FRAME_DATA_VIDEO_ENC_PARAMS);
  if (data == nullptr) return std::nullopt;
  auto* parameters = reinterpret_cast<AVVideoEncParams*>(data->data);
  if (parameters->type != AV_VIDEO_ENC_PARAMS_H264) return std::nullopt;
  double sum = 0;
  for (unsigned i = 0; i < parameters->nb_blocks; ++i)
    sum += parameters->qp + av_video_enc_params_block(parameters, i)->delta_qp;
  // libav's QP is of steps in codes of the coded depth, which double with each bit.
  const int depth = av_pix_fmt_desc_get(static_cast<AVPixelFormat>(frame.format))->comp[0].depth;
  return (parameters->nb_blocks > 0 ? sum / parameters->nb_blocks : parameters->qp) -
         6 * (depth - 8);
}

}  // namespace

struct Reader::State {
  std::filesystem::path path;
  ReaderOptions options;
  Warn warn;
  InputPtr input;
  // One file for each frame; empty for a video.
  std::vector<std::filesystem::path> pictures;
  std::size_t next_picture = 0;
  // Number of messages of the decoder and of flawed frames.
  std::atomic<int> doubts = 0;
  CodecPtr codec;
  PacketPtr packet;
  FramePtr frame;
  int stream_index = -1;
  StreamInfo info;
  Layout layout;
  Orientation orientation;
  image::Colour coded_colour;
  bool draining = false;
  bool finished = false;
  bool read_failed = false;
  // True after a packet failed: frames are suspect until the next key frame.
  bool broken = false;
  // True once a frame was decoded that refers to no missing one.
  bool has_whole_frame = false;
  std::int64_t corrupt = 0;
  // Number of damaged frames among those that are handed out.
  std::int64_t damaged = 0;
  // Number of frames that the decoder has returned.
  std::int64_t decoded = 0;
  std::int64_t handed = 0;
  // True where `frame` holds a frame that next() has not yet taken.
  bool is_pending = false;
  // True where `packet` holds one that is not yet decoded.
  bool is_packet_held = false;
  std::int64_t last_pts = AV_NOPTS_VALUE;
  std::int64_t pts_step = 1;
  // What is added to the time stamps after they began anew.
  std::int64_t pts_shift = 0;
  bool reset_is_told = false;
  // Of all frames, once seek() needs it; an empty one where the file has none.
  std::optional<FrameIndex> whole_index;
  std::optional<std::int64_t> first_pts;
  // Decoded frames that are not yet handed out: the constructor decodes the first one, and with
  // cuts the queue also holds the frames after the next.
  std::deque<Frame> ahead;
  image::Differences difference;
  // Differences between each frame and the one before it, from the frame `first_difference` on.
  std::deque<double> differences;
  std::int64_t first_difference = 1;

  [[noreturn]] void fail(const std::string& message) const {
    throw Error(message, {path.string()});
  }
  void tell(const std::string& text) const { airtruth::warn(warn, path.string() + ": " + text); }

  State(const std::filesystem::path& of, const ReaderOptions& how, Warn warn_to)
      : path(of), options(how), warn(std::move(warn_to)) {
    open_input();
    open_codec();
  }

  // Opened, and decoded up to the first frame that is handed out.
  static std::unique_ptr<State> begun(const std::filesystem::path& path,
                                      const ReaderOptions& options,
                                      Warn warn) {
    auto state = std::make_unique<State>(path, options, warn);
    if (options.first_frame > 0 && !state->go_to_first_frame() && !state->is_in_doubt()) {
      const bool is_known_end = state->info.frame_count_estimate <= options.first_frame;
      if (!is_known_end)
        state->tell(
            fmt::format("its frames cannot be found without decoding; the {} before first_frame "
                        "are decoded",
                        options.first_frame));
      state = std::make_unique<State>(path, options, Warn());  // what it says was said
    }
    const bool holds_frame = state->look_ahead();
    state->warn = std::move(warn);
    if (!holds_frame && !state->is_in_doubt()) state->explain_no_frame();
    return state;
  }

  // The same file read from the beginning by one thread.
  std::unique_ptr<State> by_one_thread() const {
    ReaderOptions alone = options;
    alone.threads = 1;
    return begun(path, alone, warn);
  }

  void explain_no_frame() const {
    if (decoded == 0)
      fail(fmt::format(
          "holds no frame of at most {} million px that can be decoded; expected a video",
          kMaxPixels / 1'000'000));
    if (options.frame_count && *options.frame_count == 0) return;
    const std::string fault = fmt::format(
        "holds {} frames; first_frame = {} is past its end", decoded, options.first_frame);
    if (options.where.file.empty()) fail(fault);
    throw Error(path.string() + " " + fault, options.where);
  }

  void open_input() {
    std::error_code ignored;
    std::string rate;
    if (auto images = numbered_images(path)) {
      if (images->doubt != nullptr)
        tell(fmt::format("has {} of its {} pictures; they are taken as consecutive frames",
                         images->doubt,
                         images->files.size()));
      pictures = std::move(images->files);
      info.is_of_pictures = true;
      info.is_rate_stated = options.picture_rate_hz.has_value();
      if (options.picture_rate_hz) {
        const AVRational stated = av_d2q(*options.picture_rate_hz, kMaxRateTerm);
        rate = fmt::format("{}/{}", stated.num, stated.den);
      }
    } else if (!std::filesystem::exists(path, ignored)) {
      fail("does not exist; expected a video");
    } else if (std::filesystem::is_directory(path, ignored)) {
      fail("is a folder without numbered images; expected a video or images such as 000000.png");
    } else if (std::filesystem::file_size(path, ignored) == 0 && !ignored) {
      fail("is empty; expected a video");
    }
    input = pictures.empty() ? open_media(path, Media::kAny)
                             : open_media(pictures.front(), Media::kNumberedImage, rate);
    for (unsigned i = 0; i < input->nb_streams; ++i)
      check_picture_size(
          input->streams[i]->codecpar->width, input->streams[i]->codecpar->height, path);
    const bool is_known = !options.with_timing && is_picture_file(*input);
    if (const int found = is_known ? 0 : find_streams(*input); found < 0)
      throw Error("cannot be read as a video: " + reason(found),
                  {pictures.empty() ? path.string() : pictures.front().string()});
    stream_index = av_find_best_stream(input.get(), AVMEDIA_TYPE_VIDEO, -1, -1, nullptr, 0);
    if (stream_index < 0) fail("holds no video stream; expected a video");
    const AVStream& stream = *input->streams[stream_index];
    if ((stream.disposition & AV_DISPOSITION_ATTACHED_PIC) != 0)
      fail("holds sound and a cover picture; expected a video");
  }

  void open_codec() {
    const AVStream& stream = *input->streams[stream_index];
    codec = decoder_of(stream, path);
    codec->thread_count = options.threads > 0 ? options.threads : usable_processors();
    codec->thread_type = FF_THREAD_FRAME | FF_THREAD_SLICE;
    codec->flags |= AV_CODEC_FLAG_OUTPUT_CORRUPT;
    count_messages(*codec, doubts);
    if (options.with_quantiser) codec->export_side_data |= AV_CODEC_EXPORT_DATA_VIDEO_ENC_PARAMS;
    codec->err_recognition = AV_EF_CRCCHECK | AV_EF_BITSTREAM | AV_EF_BUFFER;
    // A picture is whole or none; frames of a video are damaged until the next key frame. libav's
    // reader of TIFF would also refuse each tag that it does not know, such as that of the unit.
    if (!pictures.empty() && codec->codec_id != AV_CODEC_ID_TIFF)
      codec->err_recognition |= AV_EF_EXPLODE;
    if (const int opened = avcodec_open2(codec.get(), nullptr, nullptr); opened < 0)
      fail(std::string("cannot be decoded (") + codec->codec->name + "): " + reason(opened));
    doubts = 0;  // some decoders tell their version
    packet.reset(av_packet_alloc());
    frame.reset(av_frame_alloc());
    info.codec = codec->codec->name;
    describe_stream(stream);
  }

  void warn_of_fields(const AVStream& stream) const {
    const AVFieldOrder order = stream.codecpar->field_order;
    if (order == AV_FIELD_UNKNOWN || order == AV_FIELD_PROGRESSIVE) return;
    tell(
        "is interlaced, and its frames are taken whole, each of two moments; `ffmpeg -i IN -vf "
        "bwdif OUT` makes a video of one picture for each field");
  }

  void describe_stream(const AVStream& stream) {
    warn_of_fields(stream);
    info.tags = tags_of(*input);
    info.time_base = rational(stream.time_base);
    const AVRational average =
        stream.avg_frame_rate.num > 0 ? stream.avg_frame_rate : stream.r_frame_rate;
    if (average.num > 0 && average.den > 0) info.frame_rate = rational(average);
    info.variable_frame_rate =
        stream.avg_frame_rate.num > 0 && stream.r_frame_rate.num > 0 &&
        std::abs(av_q2d(stream.avg_frame_rate) / av_q2d(stream.r_frame_rate) - 1) > 0.01;
    orientation = orientation_of(display_matrix_of(stream));
    info.rotation_deg = orientation.clockwise_deg;
    info.frame_count_estimate = shown_frames(stream);
    info.is_frame_count_stated = info.frame_count_estimate > 0 || !pictures.empty();
    if (info.frame_count_estimate <= 0 && input->duration > 0)
      info.frame_count_estimate = static_cast<std::int64_t>(std::llround(
          static_cast<double>(input->duration) / AV_TIME_BASE * info.frame_rate.value()));
    if (!pictures.empty()) info.frame_count_estimate = std::ssize(pictures);
    pts_step = std::max<std::int64_t>(
        1, std::llround(1.0 / (info.frame_rate.value() * info.time_base.value())));
  }

  void describe(AVFrame& first) {
    check_picture_size(first.width, first.height, path);
    const auto format = static_cast<AVPixelFormat>(first.format);
    const char* name = av_get_pix_fmt_name(format);
    const auto known = layout_of(format);
    if (!known)
      fail(std::string("has the pixel format ") + (name != nullptr ? name : "?") +
           "; expected 4:2:0, 4:2:2, 4:4:4, grey or RGB (convert it: ffmpeg -i IN -pix_fmt yuv420p "
           "OUT)");
    layout = *known;
    info.pixel_format = name;
    if (layout.shift > 0)
      tell("has " + std::to_string(8 + layout.shift) + " bits a sample; they are rounded to 8");
    coded_colour.chroma = layout.chroma;
    const auto matrix =
        layout.rgb ? image::Matrix::kRgb : matrix_of(first.colorspace, first.height);
    if (!matrix) {
      const char* space = av_color_space_name(first.colorspace);
      fail(std::string("has the colour matrix ") + (space != nullptr ? space : "?") +
           "; expected bt709, bt470bg, smpte170m, smpte240m, fcc or bt2020");
    }
    const bool is_unlikely = !layout.rgb && *matrix == image::Matrix::kRgb;
    coded_colour.matrix = is_unlikely ? image::Matrix::kBt601 : *matrix;
    // libav's readers of PGM and TIFF state no range; grey of a still is of the full one.
    const bool is_grey_still = layout.chroma == image::Chroma::kNone &&
                               (info.is_of_pictures || is_picture_file(*input)) &&
                               first.color_range == AVCOL_RANGE_UNSPECIFIED;
    const bool full = layout.full_range || is_grey_still || first.color_range == AVCOL_RANGE_JPEG;
    coded_colour.range = full ? image::Range::kFull : image::Range::kLimited;
    coded_colour.siting = siting_of(first.chroma_location);
    info.primaries_tag = first.color_primaries;
    info.transfer_tag = first.color_trc;
    info.width = first.width;
    info.height = first.height;
    // Where the container states no shape of the pixels, as MPEG's streams, the codec's counts.
    const AVRational aspect =
        av_guess_sample_aspect_ratio(input.get(), input->streams[stream_index], &first);
    if (aspect.num > 0) info.sample_aspect = rational(aspect);
    info.colour = coded_colour;
    if (info.rotation_deg == 90 || info.rotation_deg == 270) {
      std::swap(info.width, info.height);
      std::swap(info.sample_aspect.num, info.sample_aspect.den);
      if (coded_colour.chroma == image::Chroma::k422) info.colour.chroma = image::Chroma::k440;
      if (coded_colour.chroma == image::Chroma::k440) info.colour.chroma = image::Chroma::k422;
    }
  }

  // Goes to `first_frame` without the frames before it; false where they have to be decoded.
  bool go_to_first_frame() {
    if (!pictures.empty()) {
      next_picture = std::min(pictures.size(), static_cast<std::size_t>(options.first_frame));
      decoded = static_cast<std::int64_t>(next_picture);
      return true;
    }
    if (!decode_one()) return false;
    const std::int64_t first = frame->best_effort_timestamp;
    make_plain();
    describe(*frame);
    if (first == AV_NOPTS_VALUE) return false;
    const auto index = index_frames(path, stream_index, first, options.first_frame);
    const auto target = static_cast<std::size_t>(options.first_frame);
    if (!index || target >= index->pts.size() || !decode_up_to(target, *index)) return false;
    decoded = options.first_frame;
    return true;
  }

  // Makes a frame of the index the pending one, without the frames before its key frame; false
  // where they have to be decoded.
  bool decode_up_to(std::size_t target, const FrameIndex& index) {
    // The second key packet serves where the first is no true beginning: a picture after it refers
    // to one before it.
    for (const std::size_t back : {0u, 1u}) {
      const auto key = index.key_for(target, back);
      if (!key || !decode_from(*key, index, target)) continue;
      is_pending = true;
      last_pts = AV_NOPTS_VALUE;
      return true;
    }
    return false;
  }

  // Decodes from a key packet up to a frame of the index; false where what is decoded is not what
  // the index says, or refers to what is before the key packet.
  bool decode_from(const KeyPacket& key, const FrameIndex& index, std::size_t target) {
    if (!go_to_packet(key)) return false;
    avcodec_flush_buffers(codec.get());
    draining = broken = false;
    auto expected = static_cast<std::size_t>(
        std::lower_bound(index.pts.begin(), index.pts.end(), key.pts) - index.pts.begin());
    const std::int64_t corrupt_before = corrupt;
    while (decode_one()) {
      const std::int64_t pts = frame->best_effort_timestamp;
      // Pictures that are shown before the key frame may refer to those before it.
      if (pts < key.pts) continue;
      if (is_flawed(*frame) || corrupt != corrupt_before || index.frame_at(pts) != expected)
        return false;
      if (expected++ == target) return true;
    }
    return false;
  }

  // Begins to read the file once more.
  bool rewind() {
    input = open_media(path, Media::kAny);
    return find_streams(*input) >= 0;
  }

  // Goes to the frame that is shown at a time stamp, or to the first frame of all where the stamps
  // do not say which one that is.
  bool seek_by_index(std::int64_t pts) {
    if (!whole_index)
      whole_index = index_frames(path, stream_index, *first_pts, kAllFrames).value_or(FrameIndex{});
    const auto& times = whole_index->pts;
    const auto shown = std::ranges::upper_bound(times, pts) - times.begin() - 1;
    if (!times.empty() &&
        decode_up_to(static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, shown)), *whole_index))
      return true;
    draining = broken = has_whole_frame = false;
    decoded = 0;
    avcodec_flush_buffers(codec.get());
    return rewind();
  }

  // Goes to the key frame at or before a time stamp, or nearer; false where the file cannot.
  bool seek(std::int64_t pts) {
    ahead.clear();
    differences.clear();
    finished = draining = broken = false;
    avcodec_flush_buffers(codec.get());
    last_pts = AV_NOPTS_VALUE;
    pts_shift = 0;
    options.first_frame = 0;
    options.frame_count.reset();
    if (!pictures.empty()) {
      next_picture =
          std::min(pictures.size() - 1, static_cast<std::size_t>(std::max<std::int64_t>(0, pts)));
      decoded = static_cast<std::int64_t>(next_picture);
    } else if ((input->iformat->flags & AVFMT_TS_DISCONT) != 0) {
      // MPEG's streams: libav seeks to a packet of any kind, and stamps may begin anew.
      return seek_by_index(pts);
    } else if (av_seek_frame(input.get(), stream_index, pts, AVSEEK_FLAG_BACKWARD) < 0) {
      return false;
    }
    return true;
  }

  // Fills `packet`. Returns a negative number at the end, as libav does. libav's own reader of
  // numbered images stops at the first gap in the numbers.
  int read_packet() {
    if (pictures.empty()) return av_read_frame(input.get(), packet.get());
    if (next_picture == pictures.size()) return AVERROR_EOF;
    const std::string bytes = read_file(pictures[next_picture]);
    if (const int made = av_new_packet(packet.get(), static_cast<int>(bytes.size())); made < 0)
      return made;
    std::copy(bytes.begin(), bytes.end(), packet->data);
    packet->stream_index = stream_index;
    packet->flags |= AV_PKT_FLAG_KEY;
    packet->pts = packet->dts = static_cast<std::int64_t>(next_picture++);
    packet->duration = 1;
    return 0;
  }

  // Reads packets up to the key packet, which `packet` then holds; false where it does not come.
  bool find_packet(const KeyPacket& key) {
    while (read_packet() >= 0) {
      if (packet->stream_index == stream_index) {
        const auto times = times_of(*packet, *input->streams[stream_index]->codecpar);
        if (!times || times->dts > key.dts) break;
        is_packet_held = times->pts == key.pts && times->dts == key.dts;
        if (is_packet_held) return true;
      }
      av_packet_unref(packet.get());
    }
    av_packet_unref(packet.get());
    return false;
  }

  // Finds a key packet anywhere in the file.
  bool go_to_packet(const KeyPacket& key) {
    if (av_seek_frame(input.get(), stream_index, key.dts, AVSEEK_FLAG_BACKWARD) >= 0 &&
        find_packet(key))
      return true;
    // Some containers seek to a later packet. All packets from the first on are read instead.
    return rewind() && find_packet(key);
  }

  // A decoder of several threads answers a packet, and the end of them, with the fault of an
  // earlier one.
  void take_result(int sent) {
    if (sent >= 0 || sent == AVERROR(EAGAIN)) return;
    ++corrupt;
    broken = true;
  }

  // True once several threads have met what may be a fault. What libav conceals it takes from
  // frames that other threads still decode, so that pixels and flags depend on the threads and on
  // the run. No frame of such a decoder is handed out any more. Those before are sound: the frame
  // of a packet comes after all before it are decoded. Pictures depend on no other.
  bool is_in_doubt() const {
    return codec->thread_count != 1 && pictures.empty() && (doubts > 0 || corrupt > 0);
  }

  // Fills `frame`; false at the end, and once it is in doubt.
  bool decode_one() {
    for (;;) {
      av_frame_unref(frame.get());
      const int got = avcodec_receive_frame(codec.get(), frame.get());
      if (is_flawed(*frame)) ++doubts;
      if (is_in_doubt()) return false;
      // Of a stream that is cut within a group of pictures, the first ones refer to pictures that
      // are gone. They are no frames, as ffmpeg, ffprobe and OpenCV count.
      if (got == 0 && !has_whole_frame && (frame->flags & AV_FRAME_FLAG_CORRUPT) != 0) continue;
      if (got == 0) {
        has_whole_frame = true;
        return true;
      }
      if (got == AVERROR_EOF) return false;
      if (got != AVERROR(EAGAIN)) {
        ++corrupt;
        broken = true;
        if (draining && got != AVERROR_INVALIDDATA) return false;
        if (draining) continue;
      }
      if (draining) continue;
      const int read = std::exchange(is_packet_held, false) ? 0 : read_packet();
      if (read < 0) {
        read_failed = read != AVERROR_EOF || (input->pb != nullptr && input->pb->error < 0);
        draining = true;
        take_result(avcodec_send_packet(codec.get(), nullptr));
        continue;
      }
      if (packet->stream_index == stream_index) {
        if ((packet->flags & AV_PKT_FLAG_CORRUPT) != 0) ++corrupt;
        take_result(avcodec_send_packet(codec.get(), packet.get()));
      }
      av_packet_unref(packet.get());
    }
  }

  // The packet of a picture has its number as time stamp. Without this check, a picture that is
  // not decoded gives all after it the labels of those before them.
  void check_pictures_before(std::int64_t picture) const {
    if (decoded < picture)
      throw Error("cannot be decoded as a picture",
                  {pictures[static_cast<std::size_t>(decoded)].string()});
  }

  std::optional<Frame> next() {
    if (finished || (options.frame_count && handed >= *options.frame_count)) return std::nullopt;
    for (;;) {
      if (!std::exchange(is_pending, false) && !decode_one()) {
        check_pictures_before(static_cast<std::int64_t>(next_picture));
        finished = true;
        return std::nullopt;
      }
      if (!pictures.empty()) check_pictures_before(frame->pts);
      Frame result = to_frame();
      make_plain();
      if (info.pixel_format.empty()) describe(*frame);
      if (++decoded <= options.first_frame) continue;
      const bool same =
          frame->width == (info.rotation_deg % 180 == 0 ? info.width : info.height) &&
          frame->height == (info.rotation_deg % 180 == 0 ? info.height : info.width) &&
          av_get_pix_fmt_name(static_cast<AVPixelFormat>(frame->format)) == info.pixel_format;
      if (!same)
        fail("changes its size or pixel format at frame " + std::to_string(decoded - 1) +
             "; expected one for all");
      if (!first_pts) first_pts = result.pts;
      result.index = handed++;
      if (result.damaged) ++damaged;
      result.time_s = static_cast<double>(result.pts - *first_pts) * info.time_base.value();
      result.picture = oriented(picture_of(*frame, layout, coded_colour), orientation);
      return result;
    }
  }

  // Decodes one more frame; false at the end.
  bool look_ahead() {
    auto one = next();
    if (!one) return false;
    if (options.with_cuts)
      if (const auto d = difference.add(one->picture)) differences.push_back(*d);
    ahead.push_back(std::move(*one));
    return true;
  }

  bool begins_shot(std::int64_t index) {
    // The differences of the neighbours, as far as they exist.
    while (first_difference < index - image::kCutNeighbours) {
      differences.pop_front();
      ++first_difference;
    }
    if (index < first_difference) return false;
    const std::vector<double> around(differences.begin(), differences.end());
    return image::is_cut(around, static_cast<std::size_t>(index - first_difference));
  }

  // The next frame to hand out; empty at the end, and once it is in doubt.
  std::optional<Frame> take() {
    const std::size_t held_back = options.with_cuts ? std::size_t{image::kCutNeighbours} : 0;
    while (ahead.size() < 1 + held_back && look_ahead()) {
    }
    if (ahead.empty() || is_in_doubt()) return std::nullopt;
    Frame one = std::move(ahead.front());
    ahead.pop_front();
    if (options.with_cuts) one.begins_shot = !one.damaged && begins_shot(one.index);
    return one;
  }

  std::optional<Frame> shown_at(double time_s) {
    const double step_s = static_cast<double>(pts_step) * info.time_base.value();
    const auto wanted =
        *first_pts +
        static_cast<std::int64_t>(std::floor((time_s + 0.5 * step_s) / info.time_base.value()));
    if (!seek(wanted)) return std::nullopt;
    // The frame that is shown at a time is the last one that does not begin after it.
    std::optional<Frame> shown;
    while (auto one = next()) {
      if (shown && one->pts > wanted) break;
      shown = std::move(one);
      if (shown->pts >= wanted) break;
    }
    if (shown)
      shown->index = std::llround(static_cast<double>(shown->pts - *first_pts) /
                                  static_cast<double>(pts_step));
    return shown;
  }

  // The parts of a recording, put together, may each begin their time stamps anew.
  std::int64_t after_reset(std::int64_t pts) {
    if (!std::exchange(reset_is_told, true))
      tell(
          fmt::format("its time stamps go back by {:.2f} s at frame {}; the frames from there on "
                      "follow those before them",
                      static_cast<double>(last_pts - pts) * info.time_base.value(),
                      decoded));
    pts_shift += last_pts + pts_step - pts;
    return last_pts + pts_step;
  }

  bool ends_early() const {
    if (!finished) return false;
    if (read_failed) return true;
    const AVStream& stream = *input->streams[stream_index];
    if (stream.nb_frames > 0) return decoded + corrupt < shown_frames(stream);
    // Matroska stores no number of frames, so the duration decides. One second of slack allows for
    // sound that is longer than the picture.
    if (input->duration <= 0 || !first_pts || options.first_frame > 0) return false;
    // The duration counts from the time 0, or from a first frame that is shown before it.
    const std::int64_t begin_pts = std::min<std::int64_t>(*first_pts, 0);
    const double seen_s = static_cast<double>(last_pts - begin_pts) * info.time_base.value();
    return seen_s + 1.0 < static_cast<double>(input->duration) / AV_TIME_BASE;
  }

  void tell_end() {
    if (corrupt > 0 || damaged > 0)
      tell(fmt::format("{} corrupt packets; {} frames are flagged damaged", corrupt, damaged));
    if (ends_early()) tell(fmt::format("ends early, after {} frames", handed));
  }

  Frame to_frame() {
    Frame result;
    if (is_flawed(*frame)) {
      broken = true;
    } else if (is_key_frame(*frame)) {
      broken = false;
    }
    // Frames that depend on a damaged frame are damaged as well, up to the next key frame.
    result.damaged = broken;
    std::int64_t pts = frame->best_effort_timestamp;
    if (pts == AV_NOPTS_VALUE)
      pts = last_pts == AV_NOPTS_VALUE ? 0 : last_pts + pts_step;
    else
      pts += pts_shift;
    if (last_pts != AV_NOPTS_VALUE && pts < last_pts && (last_pts - pts) / pts_step > kMaxReordered)
      pts = after_reset(pts);
    if (last_pts != AV_NOPTS_VALUE && pts <= last_pts) pts = last_pts + 1;
    last_pts = pts;
    result.pts = pts;
    result.quantiser = quantiser_of(*frame);
    return result;
  }

  // Stills use formats that no Picture can hold.
  void make_plain() {
    const auto format = static_cast<AVPixelFormat>(frame->format);
    const AVPixelFormat plain = plain_kin(format);
    if (plain == AV_PIX_FMT_NONE) return;
    if (info.pixel_format.empty() && av_pix_fmt_desc_get(format)->comp[0].depth > 8)
      tell("has more than 8 bits a sample; they are taken to 8");
    frame = in_format(*frame, plain);
  }
};

Reader::Reader(const std::filesystem::path& path, const ReaderOptions& options, Warn warn)
    : state_(State::begun(path, options, once(std::move(warn)))) {
  if (state_->is_in_doubt()) state_ = state_->by_one_thread();
}

void expect_rate(const std::filesystem::path& video,
                 const StreamInfo& info,
                 const std::optional<double>& rate_hz) {
  if (!info.is_rate_stated)
    throw Error(
        "holds numbered pictures, which state no rate; expected their frames a second "
        "(--frame-rate, in a call frame_rate_hz)",
        {video.string()});
  if (rate_hz && !info.is_of_pictures)
    throw Error("is a video, which states its own rate; --frame-rate is for numbered pictures",
                {video.string()});
}

Reader::~Reader() = default;
Reader::Reader(Reader&&) noexcept = default;
Reader& Reader::operator=(Reader&&) noexcept = default;

const StreamInfo& Reader::info() const { return state_->info; }

std::optional<Frame> Reader::next() {
  std::optional<Frame> frame = state_->take();
  if (!frame && state_->is_in_doubt()) {
    const std::int64_t taken = state_->handed - std::ssize(state_->ahead);
    state_ = state_->by_one_thread();
    for (std::int64_t k = 0; k <= taken; ++k) frame = state_->take();
  }
  if (!frame) state_->tell_end();
  return frame;
}

std::optional<Frame> Reader::at(double time_s) {
  std::optional<Frame> shown = state_->shown_at(time_s);
  if (!state_->is_in_doubt()) return shown;
  const auto first_pts = state_->first_pts;
  state_ = state_->by_one_thread();
  state_->first_pts = first_pts;
  return state_->shown_at(time_s);
}

double time_of_first_frame_s(const std::filesystem::path& path, const ReaderOptions& options) {
  if (options.first_frame == 0) return 0;
  ReaderOptions one{.frame_count = 1, .picture_rate_hz = options.picture_rate_hz, .threads = 1};
  Reader begin(path, one);
  if (numbered_images(path))
    return static_cast<double>(options.first_frame) / begin.info().frame_rate.value();
  one.first_frame = options.first_frame;
  Reader there(path, one);
  return static_cast<double>(there.next()->pts - begin.next()->pts) *
         begin.info().time_base.value();
}

std::vector<double> Reader::times_s(std::int64_t most) const {
  if (!state_->pictures.empty() || !state_->first_pts) return {};
  const auto index = index_frames(state_->path, state_->stream_index, *state_->first_pts, most);
  std::vector<double> times;
  for (std::size_t k = 0; index && k < index->pts.size() && std::ssize(times) < most; ++k)
    times.push_back(static_cast<double>(index->pts[k] - *state_->first_pts) *
                    state_->info.time_base.value());
  return times;
}

bool are_of_rate(std::span<const double> times_s, double rate_hz) {
  // Of a frame's interval.
  constexpr double kMostOff = 0.25;
  for (std::size_t k = 0; k < times_s.size(); ++k)
    if (std::abs(times_s[k] * rate_hz - static_cast<double>(k)) > kMostOff) return false;
  return true;
}

}  // namespace airtruth::video
