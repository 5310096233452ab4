// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <airtruth/export.h>

namespace airtruth {

// One plane of 8-bit samples, row by row without padding.
struct SamplePlane {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> samples;

  const std::uint8_t* row(int y) const {
    return samples.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(width);
  }
  bool operator==(const SamplePlane&) const = default;
};

// A frame of a video in the planes of its decoder: every sample that no intruder touches is the
// background's own.
//
// Example: a picture of 641 x 480 pixels in "yuv420p" has a plane of 641 x 480 samples of Y and two
// planes of 321 x 240 samples of Cb and Cr.
struct FramePicture {
  int width = 0;
  int height = 0;
  // FFmpeg's name: "gray", "yuv420p", "yuv422p", "yuv440p", "yuv444p" or "gbrp".
  std::string pixel_format;
  // The matrix between Y'CbCr and R'G'B': "bt601", "bt709", "bt2020", or "rgb" for "gbrp".
  std::string matrix;
  // False: luma 16..235 and chroma 16..240. True: 0..255.
  bool is_full_range = false;
  // Y, Cb, Cr, or Y alone, or G, B, R.
  std::vector<SamplePlane> planes;

  bool operator==(const FramePicture&) const = default;
};

// Red, green and blue of each pixel, sRGB with 8 bits, row by row: width * height * 3 samples. All
// pixels of a chroma block have the block's chroma. Throws Error where the picture's format, matrix
// or planes are not as described above.
AIRTRUTH_API std::vector<std::uint8_t> rgb_of(const FramePicture& picture);

}  // namespace airtruth
