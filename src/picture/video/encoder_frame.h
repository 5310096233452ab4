// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "picture/video/frame.h"
#include "picture/video/libav.h"
#include "picture/video/writer.h"

// A picture in the form in which an encoder takes it.
namespace airtruth::video {

// A frame of the encoder's size and pixel format with a copy of the picture, converted to the
// colour `stored`; in the memory of the encoder's device where it has one. Throws std::bad_alloc,
// and Error where the device takes no frame.
FramePtr copied_frame(const AVCodecContext& encoder,
                      const image::Picture& picture,
                      const image::Colour& stored,
                      Format format);

// A frame whose planes are the picture's own memory. libav keeps the picture alive as long as it
// refers to it. The picture must have the encoder's pixel format, and planes of Y, Cb and Cr.
// Throws std::bad_alloc.
FramePtr lent_frame(const AVCodecContext& encoder, std::shared_ptr<const Frame> frame);

}  // namespace airtruth::video
