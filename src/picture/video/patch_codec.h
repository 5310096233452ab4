// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "foundation/image/picture.h"

// What an H.264 encoder makes of a part of a frame: encoded by libx264 at a constant quantiser, as
// a picture predicted from another (a P picture), and decoded again.
//
// The result depends on the two pictures, the quantiser and the version of libx264 alone: every
// call begins a stream of its own, and libx264 runs on one thread with the code that is the same on
// every processor.
namespace airtruth::video {

class PatchCodec {
 public:
  // quantiser: QP of ITU-T H.264, 1 (fine) to 51. Error where FFmpeg lacks libx264 or its decoder.
  explicit PatchCodec(int quantiser);
  ~PatchCodec();
  PatchCodec(PatchCodec&&) noexcept;
  PatchCodec& operator=(PatchCodec&&) noexcept;

  // True for grey, 4:2:0, 4:2:2 and 4:4:4 (RGB's planes are taken as one of luma and two of
  // chroma).
  static bool can_code(const image::Colour& colour);

  // `patch` as a decoder gives it back. `reference` is what it is predicted from, of the same size
  // and colour; it passes through the encoder at a quantiser 20 lower (a tenth of the step), so
  // that it hardly changes. Sizes of halved planes are even.
  image::Picture coded(const image::Picture& patch, const image::Picture& reference);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace airtruth::video
