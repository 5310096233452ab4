// SPDX-License-Identifier: Apache-2.0
#include "aircraft/ac3d/polygon.h"

#include <cmath>

#include <Eigen/Geometry>

namespace airtruth::ac3d {
namespace {

using Planar = std::array<double, 2>;

double doubled_area(const Planar& a, const Planar& b, const Planar& c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

// The corners projected along the normal onto two axes, counter-clockwise. The axis in which the
// normal is largest is dropped.
std::vector<Planar> projected(std::span<const Eigen::Vector3f> corners,
                              const Eigen::Vector3f& normal) {
  int away = 0;
  for (int i = 1; i < 3; ++i)
    if (std::abs(normal[i]) > std::abs(normal[away])) away = i;
  int first = (away + 1) % 3;
  int second = (away + 2) % 3;
  if (normal[away] < 0) std::swap(first, second);
  std::vector<Planar> result;
  for (const Eigen::Vector3f& corner : corners)
    result.push_back({double{corner[first]}, double{corner[second]}});
  return result;
}

class EarClipper {
 public:
  explicit EarClipper(std::vector<Planar> corners) : corners_(std::move(corners)) {
    for (std::uint32_t i = 0; i < corners_.size(); ++i) left_.push_back(i);
  }

  std::vector<std::array<std::uint32_t, 3>> clip() {
    std::size_t start = 1;  // a polygon that is convex after all becomes a fan
    while (left_.size() > 3) {
      const std::size_t ear = next_ear(start);
      result_.push_back(triangle(ear));
      left_.erase(left_.begin() + static_cast<std::ptrdiff_t>(ear));
      start = ear % left_.size();
    }
    result_.push_back({left_[0], left_[1], left_[2]});
    return std::move(result_);
  }

 private:
  std::array<std::uint32_t, 3> triangle(std::size_t i) const {
    const std::size_t n = left_.size();
    return {left_[(i + n - 1) % n], left_[i], left_[(i + 1) % n]};
  }

  double area_at(std::size_t i) const {
    const auto [a, b, c] = triangle(i);
    return doubled_area(corners_[a], corners_[b], corners_[c]);
  }

  bool is_ear(std::size_t i) const {
    if (!(area_at(i) > 0)) return false;
    const auto [a, b, c] = triangle(i);
    const Planar& pa = corners_[a];
    const Planar& pb = corners_[b];
    const Planar& pc = corners_[c];
    for (const std::uint32_t other : left_) {
      const Planar& p = corners_[other];
      if (other == a || other == b || other == c || p == pa || p == pb || p == pc) continue;
      if (doubled_area(pa, pb, p) >= 0 && doubled_area(pb, pc, p) >= 0 &&
          doubled_area(pc, pa, p) >= 0)
        return false;
    }
    return true;
  }

  std::size_t next_ear(std::size_t start) const {
    const std::size_t n = left_.size();
    for (std::size_t k = 0; k < n; ++k)
      if (is_ear((start + k) % n)) return (start + k) % n;
    std::size_t flattest = 0;  // removing a corner of no area changes nothing
    for (std::size_t i = 1; i < n; ++i)
      if (std::abs(area_at(i)) < std::abs(area_at(flattest))) flattest = i;
    return flattest;
  }

  std::vector<Planar> corners_;
  std::vector<std::uint32_t> left_;
  std::vector<std::array<std::uint32_t, 3>> result_;
};

}  // namespace

float dot_product(const Eigen::Vector3f& a, const Eigen::Vector3f& b) {
  return a.x() * b.x() + a.y() * b.y() + a.z() * b.z();
}

Eigen::Vector3f area_normal(std::span<const Eigen::Vector3f> corners) {
  Eigen::Vector3f sum(0, 0, 0);
  for (std::size_t i = 2; i < corners.size(); ++i)
    sum += (corners[i - 1] - corners[0]).cross(corners[i] - corners[0]);
  return sum;
}

bool is_concave(std::span<const Eigen::Vector3f> corners) {
  if (corners.size() < 4) return false;
  Eigen::Vector3f sum(0, 0, 0);
  Eigen::Vector3f before(0, 0, 0);  // normal at the corner before
  for (std::size_t i = 2; i < corners.size(); ++i) {
    const Eigen::Vector3f fan = (corners[i - 1] - corners[0]).cross(corners[i] - corners[0]);
    if (dot_product(fan, sum) < 0) return true;
    const Eigen::Vector3f here =
        i == 2 ? fan : (corners[i - 1] - corners[i - 2]).cross(corners[i] - corners[i - 2]);
    if (i > 2 && dot_product(here, before) < 0) return true;
    before = here;
    sum += fan;
  }
  return false;
}

std::vector<std::array<std::uint32_t, 3>> ear_clipped(std::span<const Eigen::Vector3f> corners,
                                                      const Eigen::Vector3f& normal) {
  return EarClipper(projected(corners, normal)).clip();
}

}  // namespace airtruth::ac3d
