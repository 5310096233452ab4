// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <stop_token>
#include <vector>

#include <opencv2/core.hpp>

#include "geometry/box.h"
#include "geometry/transform.h"
#include "image/picture.h"

// Where one shot of a clip ends and another begins, and how the background moves within one.
namespace airtruth::comparison {

// How far a picture differs from the one before: the mean absolute difference of luma, code values,
// each picture averaged over 32 x 24 cells.
class Differences {
 public:
  // Empty for the first picture.
  std::optional<double> add(const image::Picture& picture);

 private:
  std::vector<double> before_;
};

// The frames that begin a shot, from 1 on. differences[k]: of frame k to frame k + 1. A cut is one
// frame that differs by 6 code values or more, and by more than three times what the two frames
// before it and the two after it do: a pan or a change of exposure takes several.
std::vector<std::int64_t> cuts_of(const std::vector<double>& differences);

// The same for a whole clip.
std::vector<std::int64_t> cuts_of(const std::filesystem::path& video, const std::stop_token& stop);

// How the background moves from frame to frame, by phase correlation (Kuglin and Hines 1975) of
// what is fine in it, without the parts that `aircraft` covers.
class BackgroundShift {
 public:
  // Pixels; empty for the first frame and where the background shows too little.
  std::optional<Pixel> add(const image::Picture& picture, const std::vector<Box>& aircraft);

 private:
  cv::Mat before_;
};

}  // namespace airtruth::comparison
