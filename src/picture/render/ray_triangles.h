// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "picture/render/pixel_rays.h"
#include "picture/shade/shade.h"

// The triangles of a frame's aircraft in the space of the camera's rays: the eye is the origin and
// the axes are those of cam. A ray d meets the triangle (a, b, c) where it is on the inner side of
// three planes through the eye (Olano and Greer 1997, "Triangle scan conversion using 2D
// homogeneous coordinates", eq. 1 to 4):
//
//   E_0 = d . (b x c) >= 0,   E_1 = d . (c x a) >= 0,   E_2 = d . (a x b) >= 0
//
// for a triangle whose determinant a . (b x c) is positive. These edge functions hold for any lens,
// because d is the sample's own ray. The inverse of the distance along d is linear in d as well:
//
//   1 / s = d . m,   m = (b x c + c x a + a x b) / (a . (b x c))
//
// and the edge functions are in the ratio of the barycentric weights of a, b and c. During a span
// of time the corners move along parabolas, and so do the four vectors to within the third order of
// the angles by which they move. A part that turns is divided into spans in each of which it turns
// by little.
namespace airtruth::render {

// An aircraft of a frame.
struct PlacedInstance {
  Instance instance;
  shade::Placed placed;
  // Coefficients of 1, u and u^2 over the patch's span.
  Thrice<Vector3> eye_in_body;
  // True where the eye is outside the sphere about the aircraft.
  bool is_outside = true;
  // The pixels of the frame that it can touch.
  std::optional<PixelBox> pixels;
};
// `span`: of the patch that contains all instances.
PlacedInstance place(const Instance& instance,
                     const View& view,
                     const shade::Light& light,
                     const std::optional<Box>& search,
                     const Span& span);

// The pixels of the frame that a search box covers; empty where there are none.
std::optional<PixelBox> pixels_to_search(const std::optional<Box>& search, const View& view);

// Bounds in the frame, in pixels.
struct ScreenBounds {
  float left = std::numeric_limits<float>::infinity();
  float top = std::numeric_limits<float>::infinity();
  float right = -std::numeric_limits<float>::infinity();
  float bottom = -std::numeric_limits<float>::infinity();
};

struct RayTriangle {
  // [k][c]: of u^k and of axis c; the three edge functions and the inverse distance.
  alignas(16) std::array<std::array<std::array<float, 4>, 3>, 3> functions{};
  Eigen::Map<const Eigen::Array4f, Eigen::Aligned16> of(std::size_t k, std::size_t c) const {
    return Eigen::Map<const Eigen::Array4f, Eigen::Aligned16>(functions[k][c].data());
  }
  // Bounds of the inverse distance over the triangle.
  float nearest = 0;
  float farthest = 0;
  // At the beginning, the middle and the end of the span; between them the bounds are linear within
  // margin_px.
  Thrice<ScreenBounds> bounds;
  float margin_px = 0;
  // At all times of the span, with the margin.
  ScreenBounds over_all;
  // In RayTriangles::spans().
  std::uint32_t span = 0;
  std::uint32_t instance = 0;
  // In Placed::body_from_part.
  std::uint32_t pose = 0;
  std::uint32_t part = 0;
  std::uint32_t in_part = 0;
  bool is_opaque = true;
};

// The bounds of a triangle from one time of its span to another, in u.
ScreenBounds bounds_between(const RayTriangle& triangle, float from_u, float to_u);

class RayTriangles {
 public:
  // Adds the poses of parts that turn to the instances.
  RayTriangles(const View& view,
               const PixelBox& patch,
               const Span& span,
               std::vector<PlacedInstance>& instances);

  const std::vector<RayTriangle>& all() const { return all_; }
  const std::vector<Span>& spans() const { return spans_; }
  // The triangles that may touch a row of the patch, the nearest first (RayTriangle::nearest).
  std::span<const std::uint32_t> in_row(int y) const {
    const auto row = static_cast<std::size_t>(y - patch_.y);
    return {rows_.data() + first_[row], rows_.data() + first_[row + 1]};
  }

 private:
  // An angle from the lens's axis within which the rays of the patch lie, rad.
  using AngleOfRays = std::function<double()>;
  void add_part(const View& view,
                const Span& span,
                const AngleOfRays& angle_of_rays,
                PlacedInstance& placed,
                std::uint32_t instance,
                std::uint32_t part);
  // Of one span of a part.
  class Projected;
  void add(const Projected& projected,
           const AngleOfRays& angle_of_rays,
           std::size_t triangle,
           RayTriangle result);
  void sort_into_rows();

  PixelBox patch_;
  std::vector<RayTriangle> all_;
  std::vector<Span> spans_;
  // The index in rows_ of each row's first triangle, and the end of the last.
  std::vector<std::uint32_t> first_;
  std::vector<std::uint32_t> rows_;
};

}  // namespace airtruth::render
