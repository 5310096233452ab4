// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "picture/render/tracer.h"

// An opaque aircraft's outline without rays. Seen from the eye, a direction d lies within triangle
// (a, b, c) where it is on the inner side of the three planes through the eye and one side each:
// d . (a x b) >= 0 and so on (Olano and Greer 1997, "Triangle scan conversion using 2D homogeneous
// coordinates", eq. 1 to 4; any lens, since d is a sample's own ray). Inside a pixel d is bilinear
// in the sample's place, and so is each product: four corners give it for every sample. A sample is
// covered where any triangle covers it, so nothing needs to be sorted by depth.
//
// The samples, and what covers them, are those of the rays (Tracer::sample); this is some fifty
// times faster where a pixel needs many.
//
// While the shutter works, eye and aircraft move, and each sample has its own time. In the
// aircraft's own frame the side from a to b stays, and the test becomes the product of two lines
// (Pluecker 1865): with the sample's ray through the eye e along d,
//
//   d . (a x b) + (b - a) . (e x d) >= 0
//
// which is exact at every time. d and e x d go along parabolas over a pixel's exposure, and so do
// the products.
namespace airtruth::render {

// Which of a pixel's first n samples an aircraft covers.
struct Cover {
  int covered = 0;
  std::vector<std::int32_t> is_covered;  // 0 or -1, of each sample
};

class Silhouette {
 public:
  enum class Touch { kNone, kOpaque, kRays };

  // Sorts the actor's triangles by the pixels of the patch that they can touch. `grid` is kept.
  Silhouette(const Actor& actor, const View& view, const PixelBox& patch, const RayGrid& grid);

  // What of the aircraft may be seen in a pixel: nothing; opaque triangles alone, few enough that
  // cover() is the faster way; or anything else, which takes rays.
  Touch touch(int x, int y) const;

  // For a pixel that opaque triangles touch. Nothing is covered where the lens has no direction for
  // all of it. samples: 1 to PixelSamples::kMost.
  void cover(int x, int y, int samples, Cover& result) const;

 private:
  struct Triangle {
    // At an instant: normals, in world, of the planes through the eye and a side; inwards. While
    // things move: a x b of each side, and b - a, in body.
    std::array<Vector3, 3> side;
    std::array<Vector3, 3> edge;
    bool opaque = true;
  };
  struct Reach {  // pixels of the patch, [x0, x1) by [y0, y1)
    int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  };
  struct Seen {
    Vector3 in_world;  // from the eye
    Pixel pixel;       // in the frame; not finite where the lens has none
  };

  struct Eye;     // of the view, as a point's picture needs it
  struct Pencil;  // a pixel's rays, as the sides meet them
  static BoxBounds bounds_before_plane(const std::array<const Seen*, 3>& corners,
                                       const Eye& eye,
                                       bool& all_have_pictures);
  static Reach reach_within(const PixelBox& patch,
                            const Pixel& low,
                            const Pixel& high,
                            double margin);
  Reach reach_of(const std::array<const Seen*, 3>& corners, const Eye& eye) const;
  void add_part(const Actor& actor,
                std::size_t part,
                const std::vector<Eye>& eyes,
                std::vector<Reach>& reaches);
  Reach reach_over_time(const std::vector<std::array<const Seen*, 3>>& corners,
                        const std::vector<Eye>& eyes) const;
  Reach reach_of_disc(const aircraft::Mesh& mesh,
                      const aircraft::Part& part,
                      const std::vector<Eye>& eyes) const;
  Pencil pencil_of(int x, int y) const;
  template <typename Side, typename ProductsOf, typename SideOf, typename Place>
  void cover_by(int x,
                int y,
                int samples,
                const ProductsOf& products_of,
                const SideOf& side_of,
                const Place& place,
                Cover& result) const;
  void cover_moving(int x, int y, const Pencil& pencil, int samples, Cover& result) const;
  void cover_still(int x, int y, const Pencil& pencil, int samples, Cover& result) const;
  void sort_by_pixel(const std::vector<Reach>& reaches);
  std::span<const std::uint32_t> triangles_of(int x, int y) const;
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y - patch_.y) * static_cast<std::size_t>(patch_.width) +
           static_cast<std::size_t>(x - patch_.x);
  }

  PixelBox patch_;
  const RayGrid& grid_;
  const Actor& actor_;
  std::vector<Triangle> triangles_;
  std::vector<std::uint32_t> first_;  // of each pixel in by_pixel_; one more at the end
  std::vector<std::uint32_t> by_pixel_;
  std::vector<Touch> touch_;
};

}  // namespace airtruth::render
