// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>

// The region of the own aircraft, from a first decision for each pixel. Matrices are at the working
// size unless their comment says otherwise; a region is 1 at the aircraft and 0 elsewhere.
namespace airtruth::own_aircraft {

// The largest standard deviation over time, code values, that a pixel of the aircraft may have: a
// multiple of the one that most of the candidate pixels have.
float steady_limit(const cv::Mat& spread, const cv::Mat& candidates);

// Takes certainty from the labels of pixels that change more over time than the aircraft. A pixel
// of the world also fits badly if the aircraft hides its place in the other frame; but the world
// changes over the whole clip, and the aircraft does not.
void distrust_changing(cv::Mat& labels, const cv::Mat& spread, float steady);

// The region that GrabCut finds from labels and features (FrameSums::features).
cv::Mat region_from_labels(const cv::Mat& features, const cv::Mat& labels);

// Keeps the parts of the region that reach the border of the picture, since the aircraft carries
// the camera, and of which enough is certain (`certain`) to stay still while the world moves.
void keep_certain_parts(cv::Mat& region, const cv::Mat& certain, const cv::Mat& spread);

// Refines the border of the region to full-size pixels. Only a band along the border is decided
// anew; the result at the working size holds elsewhere. `features` and `spread` are at full size,
// and so is the result.
cv::Mat refined(const cv::Mat& region,
                const cv::Mat& features,
                const cv::Mat& spread,
                float steady);

}  // namespace airtruth::own_aircraft
