// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>

#include <opencv2/core.hpp>

#include "foundation/geometry/box.h"
#include "foundation/image/mats.h"
#include "foundation/image/picture.h"

// OpenCV's drawing functions for packed sRGB pictures. Colours are red, green, blue.
namespace airtruth::drawing {

const cv::Scalar kGreen(64, 255, 96);
const cv::Scalar kAmber(255, 176, 32);
const cv::Scalar kWhite(245, 245, 245);
const cv::Scalar kGrey(150, 150, 150);
const cv::Scalar kBlack(0, 0, 0);
// Background of pictures side by side.
const cv::Scalar kDarkPaper(28, 28, 30);

// The colour of the intruder with this index: the hues of Okabe and Ito's palette (2008), which
// people with every kind of colour vision can distinguish, lightened for lines on video. The
// colours repeat from the ninth intruder on.
cv::Scalar intruder_colour(std::size_t index);

// A picture of kDarkPaper alone.
image::Rgb8 dark_paper(int width, int height);

image::Rgb8 resized(const image::Rgb8& picture, int width, int height, int interpolation);
// `scale` times as large, at least one pixel wide and high.
image::Rgb8 scaled(const image::Rgb8& picture, double scale, int interpolation);

// Draws text with a dark rim, which is legible on any background. (x, y) is the left end of the
// baseline.
void text(cv::Mat& canvas,
          const std::string& words,
          int x,
          int y,
          double size_px,
          const cv::Scalar& colour);
int text_width(const std::string& words, double size_px);

// The size of everything that text() draws: letters, the parts below the baseline, and the rim.
cv::Size text_size(const std::string& words, double size_px);

// Draws text so that its text_size() starts at the upper left corner of `place`.
void text_in(cv::Mat& canvas,
             const std::string& words,
             const PixelBox& place,
             double size_px,
             const cv::Scalar& colour);

// `words`, shortened with "..." until the width of text_size() is at most `width`.
std::string fitted(const std::string& words, double size_px, int width);

// Draws the outline of a scaled box, just outside the box: pixel (x, y) of the box lies at (x *
// scale, y * scale) of the canvas.
void outline(
    cv::Mat& canvas, const Box& box, double scale, const cv::Scalar& colour, int thickness = 1);
void dashed_outline(cv::Mat& canvas, const Box& box, double scale, const cv::Scalar& colour);

}  // namespace airtruth::drawing
