// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "picture/render/nearest.h"
#include "picture/render/reach.h"

// Triangles whose sides are straight lines in the picture: all in front of a pinhole, and small
// ones under any lens. A side is one linear function of the place in the picture (Pineda 1988, "A
// parallel algorithm for polygon rasterization"), which costs far less for each pixel than the
// planes of silhouette.h. The reciprocal of the depth is such a function too.
//
// During an exposure the corners of such a triangle move along parabolas. Over one pixel's exposure
// each corner moves uniformly about its mean place, and each side moves as its middle does and does
// not turn. Two triangles that share a side agree on it, so that no gap opens between them.
namespace airtruth::render {

// A triangle over one pixel.
struct PixelSides {
  bool is_outside = false;
  // Number of the sides that cross the pixel; they come first.
  int crossing = 0;
  std::array<Straight, 3> side;
  // The strips of the pixel's samples that the triangle can touch.
  unsigned strips = kAllStrips;
};

// The pixel of a triangle's picture: its place in the frame, and the middle of its exposure in the
// patch's span, from -1 to 1.
struct PixelPlace {
  int x = 0;
  int y = 0;
  double u = 0;
};

// How far a triangle may be from straight sides and a uniform motion.
struct Tolerance {
  // Its size under a lens other than a pinhole.
  double size_px = 0;
  // How far a corner may be, at any time of a pixel's exposure, from where the uniform motion of
  // its sides puts it.
  double motion_px = 0;
};
// For its outline.
// - An arc of 100 px radius deviates from a chord of 1 px by 1/800 px.
// - The motion: what is left out is 0 in the mean over the exposure, so that alpha is wrong only
//   where a side passes a pixel's edge, and there by at most a quarter of this (a deviation that is
//   uniform between -e and e adds e / 4 to the mean of max(0, place)): 1/100, which is what the
//   samples leave.
constexpr Tolerance kStraight{1, 0.04};
// For its depth, and for places on it.
constexpr Tolerance kNearlyStraight{16, 0.5};

// A triangle at an instant.
class StillTriangle {
 public:
  // Empty where the sides bend too far or the picture is not finite.
  static std::optional<StillTriangle> of(const Corners& corners,
                                         const Eye& eye,
                                         const Tolerance& tolerance);

  // `depth` receives the triangle's depth where it is not null and the pixel is not outside.
  PixelSides over(const PixelPlace& pixel, PixelDepth* depth) const;

  // False where a corner has no depth.
  bool has_depth() const { return farthest() > 0; }
  // The largest and the smallest nearness (Seen) of the corners.
  float nearest() const { return std::max({nearness_[0], nearness_[1], nearness_[2]}); }
  float farthest() const { return std::min({nearness_[0], nearness_[1], nearness_[2]}); }
  // The nearness of the triangle over a pixel.
  PixelDepth depth_over(const PixelPlace& pixel) const;
  // The barycentric weights of the second and the third corner, as in Hit, at a place of the pixel
  // and a time of its exposure, each from 0 to 1.
  std::array<float, 2> weights_at(const PixelPlace& pixel,
                                  const std::array<float, 3>& place_and_time) const;

 private:
  // Four linear functions of the place in a pixel.
  struct PixelLines {
    std::array<float, 4> at_corner;
    std::array<float, 4> per_x;
    std::array<float, 4> per_y;
    Straight line(std::size_t k) const { return {at_corner[k], per_x[k], per_y[k], 0}; }
  };
  // The same of the place in the frame, side by side, so that one vector instruction computes
  // several of them.
  struct Lines {
    std::array<double, 4> at_origin{};
    std::array<double, 4> per_x{};
    std::array<double, 4> per_y{};
    PixelLines over(const PixelPlace& pixel) const {
      const double x = pixel.x;
      const double y = pixel.y;
      PixelLines result;
      for (std::size_t k = 0; k < 4; ++k) {
        result.at_corner[k] = static_cast<float>(at_origin[k] + per_x[k] * x + per_y[k] * y);
        result.per_x[k] = static_cast<float>(per_x[k]);
        result.per_y[k] = static_cast<float>(per_y[k]);
      }
      return result;
    }
  };
  static constexpr std::size_t kDepth = 3;
  StillTriangle() = default;
  PixelDepth depth_of(const PixelLines& lines) const {
    return {lines.line(kDepth), farthest(), nearest()};
  }

  // The first three: the value of the side opposite to a corner, in pixels times the side's length,
  // positive inside. kDepth: the nearness.
  Lines lines_;
  double left_ = 0;
  double right_ = 0;
  std::array<float, 3> nearness_;
};

// A triangle during the exposure of one row of pixels, all of which have one time: what over()
// below computes is shared by the row's pixels but for their column.
struct RowTriangle {
  struct Side {
    // At column 0.
    double at_start = 0;
    double per_x = 0;
    float per_y = 0;
    float per_time = 0;
  };
  std::array<Side, 3> side;
  // The nearness at column 0, as in Side, and its bounds.
  Side nearness;
  float farthest_depth = 0;
  float nearest_depth = 0;
  // A box about the triangle in the middle of the exposure: columns of the frame, and rows from the
  // top of this one.
  double left = 0;
  double right = 0;
  float top = 0;
  float bottom = 0;
  // What the triangle's middle moves from the middle of the exposure to its end, in pixels, and how
  // far beyond that a sample may be from the box.
  float drift_x = 0;
  float drift_y = 0;
  float spread = 0;
  // True where the triangle is seen edge-on or outside the row.
  bool is_outside = true;

  // As in StillTriangle.
  PixelSides over(int x, PixelDepth* depth) const;
  float nearest() const { return nearest_depth; }
  // The columns of pixels that the triangle can touch, [first, last). Empty: none.
  std::pair<int, int> columns() const;
};

// A triangle during an exposure.
class MovingTriangle {
 public:
  // Empty where the sides bend or the shape changes too much, or the picture is not finite.
  // corners, eyes: at the three moments of the patch's span. exposure_share: a pixel's exposure as
  // a share of that span.
  static std::optional<MovingTriangle> of(const std::vector<Corners>& corners,
                                          const std::vector<Eye>& eyes,
                                          double exposure_share,
                                          const Tolerance& tolerance);

  // As in StillTriangle.
  PixelSides over(const PixelPlace& pixel, PixelDepth* depth) const;
  bool has_depth() const { return has_depth_; }
  float nearest() const { return nearest_; }
  PixelDepth depth_over(const PixelPlace& pixel) const;
  std::array<float, 2> weights_at(const PixelPlace& pixel,
                                  const std::array<float, 3>& place_and_time) const;

  // Over the row y of pixels, whose exposure has its middle at u.
  RowTriangle over_row(int y, double u) const;

  // How far the middle moves during the exposure of a pixel.
  Pixel motion_px(const PixelPlace& pixel) const { return 2 * now(pixel).drift; }

 private:
  MovingTriangle() = default;
  // The triangle over one pixel.
  struct Now {
    // The mean places of the corners during the pixel's exposure, relative to the pixel.
    std::array<Pixel, 3> corner;
    // What is added to each from the middle of the exposure to its end.
    std::array<Pixel, 3> drift_of;
    // The mean of those.
    Pixel drift;

    // Of the side from corner k to the next.
    Pixel drift_of_side(std::size_t k) const { return 0.5 * (drift_of[k] + drift_of[(k + 1) % 3]); }
    // How far, along each axis, the sides of the triangle may go beyond one that moves by `drift`.
    double spread_px() const;
  };
  Now now(const PixelPlace& pixel) const;
  // The nearness over a pixel, from its corner and the beginning of its exposure.
  struct DepthPlane {
    double at_corner = 0;
    Pixel slope;
    double per_time = 0;
    float farthest = 0;
    float nearest = 0;
  };
  DepthPlane depth_plane(double u,
                         const std::array<Pixel, 3>& corner,
                         const Pixel& drift,
                         double area) const;
  PixelDepth depth_at(double u,
                      const std::array<Pixel, 3>& corner,
                      const Pixel& drift,
                      double area) const;
  double nearness(std::size_t corner, double u) const {
    const Thrice<double>& n = nearness_[corner];
    return n[0] + u * (n[1] + u * n[2]);
  }

  // The coefficients of 1, u and u^2 of each corner.
  std::array<Thrice<Pixel>, 3> corner_;
  // Half of a pixel's exposure, in u.
  double half_ = 0;
  // The same for the nearness of each corner.
  std::array<Thrice<double>, 3> nearness_;
  float nearest_ = 0;
  bool has_depth_ = false;
};

}  // namespace airtruth::render
