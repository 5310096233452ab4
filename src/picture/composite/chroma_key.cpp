// SPDX-License-Identifier: Apache-2.0
#include "picture/composite/chroma_key.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "foundation/base/error.h"
#include "foundation/image/colour.h"
#include "foundation/image/mats.h"

namespace airtruth::composite {
namespace {

// OpenCV's pixel centres have integer coordinates; airtruth's have half-integer ones.
cv::Matx33d cv_from_homography(const Homography& h) {
  Homography to_corner = Homography::Identity();
  to_corner.topRightCorner<2, 1>().setConstant(0.5);
  Homography to_centre = Homography::Identity();
  to_centre.topRightCorner<2, 1>().setConstant(-0.5);
  const Homography centred = to_centre * h * to_corner;
  return cv::Matx33d(centred.data()).t();  // Eigen holds columns, OpenCV rows
}

const cv::Scalar kGreen(0, 255, 0);

// 255 where the picture takes its pixel from C.
std::vector<unsigned char> replaced_pixels(const cv::Mat3b& d, const ChromaKeyOptions& options) {
  std::vector<unsigned char> replaced(pixels_in(d.rows, d.cols));
  cv::Mat1b shows(d.rows, d.cols, replaced.data());
  const int t = options.green_tolerance;
  cv::inRange(d, cv::Scalar(0, 255 - t, 0), cv::Scalar(t, 255, t), shows);
  cv::bitwise_not(shows, shows);
  if (options.own_aircraft != nullptr) shows.setTo(0, image::mat_of(*options.own_aircraft) < 128);
  return replaced;
}

std::uint8_t sample_of(float value) {
  return static_cast<std::uint8_t>(std::clamp(std::lround(value), 0L, 255L));
}

// Writes C's pixels into the planes. A chroma sample becomes the mean over its block, in which
// pixels that keep their background keep its chroma.
class PlaneWriter {
 public:
  PlaneWriter(image::Picture& frame, const cv::Mat3b& c, const std::vector<unsigned char>& replaced)
      : frame_(frame), c_(c), replaced_(replaced), colour_code_(frame.colour) {}

  void write() {
    for (int y = 0; y < frame_.height; ++y) {
      for (int x = 0; x < frame_.width; ++x)
        if (is_replaced(x, y)) frame_.planes[0].row(y)[x] = sample_of(ycc(x, y).y);
    }
    if (frame_.plane_count == 1) return;
    for (int cy = 0; cy < frame_.planes[1].height; ++cy) {
      for (int cx = 0; cx < frame_.planes[1].width; ++cx) write_chroma(cx, cy);
    }
  }

 private:
  bool is_replaced(int x, int y) const { return replaced_[index_in(frame_.width, x, y)] != 0; }

  image::Ycc ycc(int x, int y) const {
    const cv::Vec3b& rgb = c_(y, x);
    return colour_code_.ycc_from_rgb({static_cast<float>(rgb[0]) / 255.0f,
                                      static_cast<float>(rgb[1]) / 255.0f,
                                      static_cast<float>(rgb[2]) / 255.0f});
  }

  void write_chroma(int cx, int cy) {
    const int sx = image::log2_chroma_width(frame_.colour.chroma);
    const int sy = image::log2_chroma_height(frame_.colour.chroma);
    std::uint8_t& cb_sample = frame_.planes[1].row(cy)[cx];
    std::uint8_t& cr_sample = frame_.planes[2].row(cy)[cx];
    float cb = 0;
    float cr = 0;
    int pixels = 0;
    bool any = false;
    for (int y = cy << sy; y < std::min((cy + 1) << sy, frame_.height); ++y) {
      for (int x = cx << sx; x < std::min((cx + 1) << sx, frame_.width); ++x, ++pixels) {
        image::Ycc here{0, static_cast<float>(cb_sample), static_cast<float>(cr_sample)};
        if (is_replaced(x, y)) {
          here = ycc(x, y);
          any = true;
        }
        cb += here.cb;
        cr += here.cr;
      }
    }
    if (!any) return;
    cb_sample = sample_of(cb / static_cast<float>(pixels));
    cr_sample = sample_of(cr / static_cast<float>(pixels));
  }

  image::Picture& frame_;
  const cv::Mat3b& c_;
  const std::vector<unsigned char>& replaced_;
  image::ColourCode colour_code_;
};

}  // namespace

std::vector<unsigned char> composite_chroma_key(image::Picture& frame,
                                                const image::Rgb8& virtual_image,
                                                const Homography& frame_from_reference,
                                                const ChromaKeyOptions& options,
                                                ChromaKeyImages* images) {
  check(virtual_image.width == frame.width && virtual_image.height == frame.height,
        "the virtual image is of the frame's size");
  check(options.own_aircraft == nullptr || (options.own_aircraft->width == frame.width &&
                                            options.own_aircraft->height == frame.height),
        "the own aircraft's mask is of the frame's size");
  const cv::Matx33d h = cv_from_homography(frame_from_reference);
  const image::Rgb8 background = image::rgb8_from_picture(frame);
  const cv::Mat3b virtual_view = image::mat_of(virtual_image);
  const cv::Size size(frame.width, frame.height);
  cv::Mat3b a, c, d;
  cv::warpPerspective(image::mat_of(background),
                      a,
                      h,
                      size,
                      cv::INTER_LANCZOS4 | cv::WARP_INVERSE_MAP,
                      cv::BORDER_REPLICATE);
  cv::Mat3b b = a.clone();
  cv::Mat1b is_green;
  cv::inRange(virtual_view, kGreen, kGreen, is_green);
  virtual_view.copyTo(b, ~is_green);
  cv::warpPerspective(b, c, h, size, cv::INTER_LANCZOS4, cv::BORDER_REPLICATE);
  cv::warpPerspective(virtual_view, d, h, size, cv::INTER_LANCZOS4, cv::BORDER_CONSTANT, kGreen);
  std::vector<unsigned char> replaced = replaced_pixels(d, options);
  PlaneWriter(frame, c, replaced).write();
  if (images != nullptr)
    *images = {image::rgb8_of(a), image::rgb8_of(b), image::rgb8_of(c), image::rgb8_of(d)};
  return replaced;
}

}  // namespace airtruth::composite
