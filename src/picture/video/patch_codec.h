// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "foundation/image/picture.h"

// The effect of an H.264 encoder on a part of a frame: libx264 encodes the part at a constant
// quantiser, predicted from another picture (a P picture), and a decoder restores it.
//
// The result depends only on the two pictures, the quantiser and the version of libx264. Every call
// starts a new stream, and libx264 runs on one thread with the code that is the same on every
// processor.
namespace airtruth::video {

class PatchCodec {
 public:
  // quantiser: QP of ITU-T H.264, from 1 (fine) to 51. Error where FFmpeg lacks libx264 or its
  // decoder.
  explicit PatchCodec(int quantiser);
  ~PatchCodec();
  PatchCodec(PatchCodec&&) noexcept;
  PatchCodec& operator=(PatchCodec&&) noexcept;

  // True for grey, 4:2:0, 4:2:2 and 4:4:4. RGB's planes are coded as one plane of luma and two of
  // chroma.
  static bool can_code(const image::Colour& colour);

  // `patch` after encoding and decoding. `reference` is the picture of the same size and colour
  // from which it is predicted. The encoder codes the reference at a quantiser 20 lower (a tenth of
  // the step), so that it hardly changes. The sides of halved planes are even.
  image::Picture coded(const image::Picture& patch, const image::Picture& reference);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace airtruth::video
