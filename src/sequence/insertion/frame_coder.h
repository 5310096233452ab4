// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "foundation/image/picture.h"
#include "picture/composite/matte.h"
#include "picture/video/patch_codec.h"

// Reproduces the traces of the clip's codec on the inserted pixels, frame after frame.
//
// A video encoder predicts a frame from the previous one as it was decoded. Each part of a frame is
// therefore coded with the last finished frame at the same place as its reference: once with the
// intruder as the codec left it, and once with the background alone. Frames are passed in order.
namespace airtruth::insertion {

class FrameCoder final : public composite::PatchCoder {
 public:
  // codec_step: the quantiser's step in code values, as calibration measures it (0.625 * 2^(QP/6),
  // ITU-T H.264, 8.5.9); QP is rounded to a whole number from 1 to 51.
  explicit FrameCoder(double codec_step);

  composite::Coded code(const PixelBox& box,
                        const image::Picture& with_layer,
                        const image::Picture& background) override;

  // Ends a frame: its coded parts are the prediction for the next frame.
  void finish_frame(const image::Picture& painted);

 private:
  // Samples of a frame, within the frame. A frame that is not finished is not painted yet.
  struct Part {
    PixelBox box{};
    image::Picture background;
    image::Picture painted;
  };
  image::Picture reference(const PixelBox& box,
                           const image::Picture& now,
                           image::Picture Part::*samples) const;

  video::PatchCodec codec_;
  std::vector<Part> past_;     // of the last finished frame
  std::vector<Part> windows_;  // of the current frame
};

}  // namespace airtruth::insertion
