// SPDX-License-Identifier: Apache-2.0
#include "camera/motion/stabilise.h"

#include <opencv2/imgproc.hpp>

#include "foundation/image/mats.h"

namespace airtruth::motion {
namespace {

// The map H for a plane whose samples have 2^sx by 2^sy pixels, in OpenCV's integer-centred
// samples.
cv::Matx33d plane_map(const Homography& h, int sx, int sy) {
  Homography pixel_from_sample = Homography::Identity();
  pixel_from_sample(0, 0) = 1 << sx;
  pixel_from_sample(1, 1) = 1 << sy;
  pixel_from_sample(0, 2) = 0.5 * (1 << sx);
  pixel_from_sample(1, 2) = 0.5 * (1 << sy);
  const Homography m = pixel_from_sample.inverse() * h * pixel_from_sample;
  return {m(0, 0), m(0, 1), m(0, 2), m(1, 0), m(1, 1), m(1, 2), m(2, 0), m(2, 1), m(2, 2)};
}

// Calls warp(source, target, sx, sy, black) for each plane, where `black` fills what has no source.
template <typename Warp>
image::Picture each_plane(const image::Picture& picture, const Warp& warp) {
  image::Picture result = image::make_picture(picture.width, picture.height, picture.colour);
  const bool rgb = picture.colour.matrix == image::Matrix::kRgb;
  const int black = picture.colour.range == image::Range::kFull || rgb ? 0 : 16;
  for (std::size_t i = 0; i < static_cast<std::size_t>(picture.plane_count); ++i) {
    const bool chroma = i > 0 && !rgb;
    const int sx = chroma ? image::log2_chroma_width(picture.colour.chroma) : 0;
    const int sy = chroma ? image::log2_chroma_height(picture.colour.chroma) : 0;
    cv::Mat target = image::mat_of(result.planes[i]);
    warp(image::mat_of(picture.planes[i]), target, sx, sy, cv::Scalar(chroma ? 128 : black));
  }
  return result;
}

}  // namespace

image::Picture stabilised(const image::Picture& picture, const Homography& frame_from_reference) {
  return each_plane(
      picture,
      [&](const cv::Mat& source, cv::Mat& target, int sx, int sy, const cv::Scalar& black) {
        cv::warpPerspective(source,
                            target,
                            plane_map(frame_from_reference, sx, sy),
                            target.size(),
                            cv::INTER_LINEAR | cv::WARP_INVERSE_MAP,
                            cv::BORDER_CONSTANT,
                            black);
      });
}

image::Picture stabilised(const image::Picture& picture,
                          const lens::Lens& lens,
                          const Quaternion& cam_from_reference) {
  // The position in the frame, in airtruth's pixels, of each pixel of the reference. Where the lens
  // has no image, the position is far outside the frame, so that the pixel becomes black.
  constexpr float kNowhere = -1e4F;
  cv::Mat map(picture.height, picture.width, CV_32FC2);
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      const auto ray = lens.ray_from_pixel({x + 0.5, y + 0.5});
      const auto pixel = ray ? lens.pixel_from_cam(cam_from_reference * *ray) : std::nullopt;
      map.at<cv::Vec2f>(y, x) =
          pixel ? cv::Vec2f(static_cast<float>(pixel->x()), static_cast<float>(pixel->y()))
                : cv::Vec2f(kNowhere, kNowhere);
    }
  return each_plane(
      picture,
      [&](const cv::Mat& source, cv::Mat& target, int sx, int sy, const cv::Scalar& black) {
        cv::Mat here;
        cv::resize(map, here, target.size(), 0, 0, cv::INTER_AREA);
        for (int y = 0; y < here.rows; ++y)
          for (int x = 0; x < here.cols; ++x) {
            cv::Vec2f& at = here.at<cv::Vec2f>(y, x);
            at = {at[0] / static_cast<float>(1 << sx) - 0.5F,
                  at[1] / static_cast<float>(1 << sy) - 0.5F};
          }
        cv::remap(
            source, target, here, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_CONSTANT, black);
      });
}

}  // namespace airtruth::motion
