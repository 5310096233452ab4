// SPDX-License-Identifier: Apache-2.0
#include "picture/video/patch_codec.h"

#include <algorithm>
#include <list>

#include "foundation/base/error.h"
#include "picture/video/libav.h"

namespace airtruth::video {
namespace {

using image::Chroma;
using image::Picture;

void check_av(int result, const char* what) {
  if (result < 0) throw Error(std::string(what) + ": " + reason(result));
}

const AVCodec* encoder_by_name() {
  const AVCodec* found = avcodec_find_encoder_by_name("libx264");
  if (found == nullptr) throw Error("the encoder libx264 is missing from this FFmpeg");
  return found;
}

const AVCodec* decoder_by_id() {
  const AVCodec* found = avcodec_find_decoder(AV_CODEC_ID_H264);
  if (found == nullptr) throw Error("the decoder of H.264 is missing from this FFmpeg");
  return found;
}

// An encoder and its decoder for pictures of one size and layout.
class Loop {
 public:
  Loop(int width, int height, Chroma chroma, int quantiser) {
    const AVCodec* encoder = encoder_by_name();
    encoder_.reset(avcodec_alloc_context3(encoder));
    encoder_->width = width;
    encoder_->height = height;
    encoder_->pix_fmt = planar_format(chroma);
    encoder_->time_base = {1, 25};
    encoder_->thread_count = 1;
    encoder_->max_b_frames = 0;
    encoder_->refs = 1;
    // The largest ratio of the quantisers of P and I pictures in libx264: the reference gets a
    // quantiser 20 lower.
    constexpr float kFinestKeyPicture = 0.1F;
    encoder_->i_quant_factor = kFinestKeyPicture;
    Settings settings;
    av_dict_set(&settings.entries, "preset", "medium", 0);
    av_dict_set(&settings.entries, "tune", "zerolatency", 0);
    av_dict_set(&settings.entries, "forced-idr", "1", 0);
    av_dict_set_int(&settings.entries, "qp", quantiser, 0);
    av_dict_set(&settings.entries, "x264-params", "cpu-independent=1:scenecut=0:weightp=0", 0);
    check_av(avcodec_open2(encoder_.get(), encoder, &settings.entries),
             "cannot encode with libx264");
    const AVCodec* decoder = decoder_by_id();
    decoder_.reset(avcodec_alloc_context3(decoder));
    decoder_->thread_count = 1;
    decoder_->flags |= AV_CODEC_FLAG_LOW_DELAY;
    check_av(avcodec_open2(decoder_.get(), decoder, nullptr), "cannot decode H.264");
  }

  bool fits(const Picture& picture) const {
    return encoder_->width == picture.width && encoder_->height == picture.height &&
           encoder_->pix_fmt == planar_format(picture.colour.chroma);
  }
  // Returns the second of two pictures after decoding. The first is a key picture, and the second
  // is predicted from it.
  Picture run(const Picture& reference, const Picture& patch) {
    encode(reference, AV_PICTURE_TYPE_I);
    encode(patch, AV_PICTURE_TYPE_P);
    send(nullptr);
    check(last_->width == patch.width && last_->height == patch.height && last_->data[0] != nullptr,
          "a decoder gives back the picture's size");
    avcodec_flush_buffers(decoder_.get());
    return picture_of(*last_, Layout{}, patch.colour);
  }

 private:
  void encode(const Picture& picture, AVPictureType type) {
    const FramePtr frame = new_frame(encoder_->pix_fmt, picture.width, picture.height);
    copy_planes(picture, *frame);
    frame->pict_type = type;
    frame->pts = pts_++;
    check_av(avcodec_send_frame(encoder_.get(), frame.get()), "cannot encode with libx264");
    check_av(avcodec_receive_packet(encoder_.get(), packet_.get()), "libx264 held a picture back");
    send(packet_.get());
    av_packet_unref(packet_.get());
  }

  void send(const AVPacket* packet) {
    check_av(avcodec_send_packet(decoder_.get(), packet), "cannot decode H.264");
    const FramePtr frame(av_frame_alloc());
    while (avcodec_receive_frame(decoder_.get(), frame.get()) >= 0) {
      av_frame_unref(last_.get());
      av_frame_move_ref(last_.get(), frame.get());
    }
  }

  CodecPtr encoder_;
  CodecPtr decoder_;
  PacketPtr packet_{av_packet_alloc()};
  FramePtr last_{av_frame_alloc()};
  std::int64_t pts_ = 0;
};

}  // namespace

struct PatchCodec::State {
  int quantiser = 0;
  // The most recently used one comes first.
  std::list<Loop> loops;
};

PatchCodec::PatchCodec(int quantiser) : state_(std::make_unique<State>()) {
  check(quantiser >= 1 && quantiser <= 51, "a quantiser of H.264 is 1 to 51");
  keep_libav_quiet();
  encoder_by_name();
  decoder_by_id();
  state_->quantiser = quantiser;
}
PatchCodec::~PatchCodec() = default;
PatchCodec::PatchCodec(PatchCodec&&) noexcept = default;
PatchCodec& PatchCodec::operator=(PatchCodec&&) noexcept = default;

bool PatchCodec::can_code(const image::Colour& colour) { return colour.chroma != Chroma::k440; }

Picture PatchCodec::coded(const Picture& patch, const Picture& reference) {
  check(can_code(patch.colour), "H.264 has the picture's layout");
  check(patch.width == reference.width && patch.height == reference.height &&
            patch.colour == reference.colour,
        "a patch and its reference are alike");
  std::list<Loop>& loops = state_->loops;
  auto loop =
      std::find_if(loops.begin(), loops.end(), [&](const Loop& l) { return l.fits(patch); });
  if (loop == loops.end()) {
    // Each loop has one size; an intruder's size changes slowly.
    constexpr std::size_t kMaxLoops = 4;
    if (loops.size() == kMaxLoops) loops.pop_back();
    loops.emplace_front(patch.width, patch.height, patch.colour.chroma, state_->quantiser);
    loop = loops.begin();
  }
  loops.splice(loops.begin(), loops, loop);
  return loops.front().run(reference, patch);
}

}  // namespace airtruth::video
