// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "picture/render/marking.h"
#include "picture/render/reach.h"

// Triangles whose sides are straight lines in the picture: all in front of a pinhole, and small
// ones under any lens. A side is one linear function of the place in the picture (Pineda 1988, "A
// parallel algorithm for polygon rasterization"), which costs far less for each pixel than the
// planes of silhouette.h.
//
// During an exposure such a triangle moves along parabolas, and over one pixel's exposure uniformly
// and without a change of its shape.
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

class StraightTriangle {
 public:
  // Empty where the sides bend, the shape changes, or the picture is not finite. corners, eyes: at
  // one moment, or at the three moments of the patch's span. exposure_share: a pixel's exposure as
  // a share of that span.
  static std::optional<StraightTriangle> of(const std::vector<Corners>& corners,
                                            const std::vector<Eye>& eyes,
                                            double exposure_share);

  // u: the middle of the pixel's exposure in the span, from -1 to 1.
  PixelSides over(int x, int y, double u) const;

 private:
  // The value of a side at a place in the frame, in pixels times the side's length: positive
  // inside.
  struct Line {
    double at_origin = 0;
    double per_x = 0;
    double per_y = 0;
  };
  StraightTriangle() = default;
  void stand_still();
  PixelSides over_moving(int x, int y, double u) const;

  bool moves_ = false;
  // If it does not move.
  std::array<Line, 3> line_;
  double left_ = 0;
  double right_ = 0;
  // The coefficients of 1, u and u^2 of each corner; the last two are used if it moves.
  std::array<Thrice<Pixel>, 3> corner_;
  // Half of a pixel's exposure, in u.
  double half_ = 0;
};

}  // namespace airtruth::render
