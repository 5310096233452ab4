// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "foundation/geometry/transform.h"
#include "foundation/image/layer.h"
#include "foundation/image/picture.h"

// The compositing of the E-Vision paper (section II.C, Figure 5), implemented step by step with
// OpenCV on full frames:
//
//   A = background warped back by H^-1 (Lanczos over 8x8)
//   B = A with the rendered pixels that are not green
//   C = B warped by H
//   D = the green virtual image warped by H
//   output = C where D is not green, else the background
//
// It is the reference with which the matte is compared, in looks and in time.
namespace airtruth::composite {

struct ChromaKeyOptions {
  const image::Mask* own_aircraft = nullptr;
  // A pixel of D is green where r <= t, g >= 255 - t and b <= t. Beyond a white edge the 8x8
  // Lanczos kernel deviates by up to 12 levels from pure green, up to three pixels away. With t = 0
  // that ringing counts as intruder, and a rim of twice resampled background is copied. The default
  // 14 is just above that deviation and loses no edge pixel that the intruder covers by more than a
  // twentieth.
  int green_tolerance = 14;
};

// Intermediate images for documents and tests; all have the frame's size.
struct ChromaKeyImages {
  image::Rgb8 a, b, c, d;
};

// `virtual_image`: the rendered intruder over pure green (0, 255, 0), in the reference frame.
// frame_from_reference: H of the paper's equation 1. Changes only samples of pixels where D is not
// green. Returns the mask of the replaced pixels (255) as one byte for each pixel, and fills
// `images` where it is not null.
std::vector<unsigned char> composite_chroma_key(image::Picture& frame,
                                                const image::Rgb8& virtual_image,
                                                const Homography& frame_from_reference,
                                                const ChromaKeyOptions& options,
                                                ChromaKeyImages* images = nullptr);

}  // namespace airtruth::composite
