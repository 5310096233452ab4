// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <opencv2/core.hpp>

#include "foundation/geometry/box.h"
#include "foundation/image/picture.h"

// Finds what stands out from the sky around it, from pixels alone, without alpha or truth.
namespace airtruth::appearance {

// Luma of a part of a picture as float code values. The area lies within the picture.
cv::Mat float_luma(const image::Picture& picture, const PixelBox& area);

// The surroundings as a plane through the samples where `where` is not 0, by least squares, fitted
// once more without what lies far from the first fit; a float picture of the size of `grey`. Where
// fewer than six samples are given, their mean.
cv::Mat surroundings_of(const cv::Mat& grey, const cv::Mat& where);

// The part of `grey` that differs from a plane through its rim by more than 8 code values and four
// times the rim's own spread, closed by 3 x 3; of the connected parts that have an area of 3 px or
// more and their middle within `reach_px` of the middle of `grey`, the largest. `whole`: parts that
// reach the edge of `grey` are left out. 8-bit, 255 inside; all 0 where there is none.
cv::Mat silhouette_of(const cv::Mat& grey, double reach_px, bool whole);

// An aircraft in the picture: its bounds in whole pixels, and the pixels within them that belong to
// it.
struct Seen {
  Box box;
  cv::Mat mask;  // of the box's size; 8-bit, 255: aircraft
};

// Finds the aircraft within a loose box: silhouette_of() in the box with a margin of a quarter of
// its larger side, at least 4 px. Returns empty where nothing stands out; where the silhouette
// reaches the margin's edge, so that its bounds are unknown; where it is smaller than 3 px in both
// directions; or where the margin leaves the picture.
std::optional<Seen> seen_in(const image::Picture& picture, const Box& loose);

}  // namespace airtruth::appearance
