// SPDX-License-Identifier: Apache-2.0
#include "aircraft/shapes/airframes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace airtruth::shapes {
namespace {

using model::Mesh;
using model::Part;
using V = Eigen::Vector3f;

bool lifts(const Part& part) { return part.spins && part.axis_in_body.z() < -0.9f; }

// The points of a part at a time.
std::vector<V> points(const Mesh& mesh, const Part& part, double time_s = 0) {
  const Eigen::Affine3f pose = model::body_from_part(part, time_s);
  std::vector<V> result;
  for (const model::Triangle& t : part.triangles)
    for (const std::uint32_t v : t.vertex) result.push_back(pose * mesh.positions[v]);
  return result;
}

std::string first_name(const Airframe& airframe) {
  std::string name;
  for (const std::string& one : made_names())
    if (made_airframe(one) == &airframe && name.empty()) name = one;
  return name;
}

template <typename Check>
void each_type(const Check& check) {
  for (const Airframe& airframe : airframes()) {
    SCOPED_TRACE(airframe.name);
    check(airframe, made_mesh(first_name(airframe)));
  }
}

// Published sizes within 2 %: lengths are those of airframes, and spans and heights hold the whole
// turn of what does not lift. The diameters of all rotors are the tables'.
TEST(Airframes, AreAsLargeAsPublished) {
  each_type([](const Airframe& airframe, const Mesh& mesh) {
    V low(1e9f, 1e9f, 1e9f), high = -low;
    std::size_t rotor = 0;
    for (const Part& part : mesh.parts) {
      double reach_m = 0;
      for (const V& p : points(mesh, part))
        reach_m =
            std::max<double>(reach_m, (p - part.centre_in_body).cross(part.axis_in_body).norm());
      if (part.spins) {
        EXPECT_NEAR(2 * reach_m, airframe.rotors[rotor++].diameter, 0.02 * reach_m) << part.name;
      }
      if (lifts(part)) continue;
      for (int step = 0; step < (part.spins ? 24 : 1); ++step)
        for (const V& p : points(mesh, part, step / 24.0 / part.revolutions_per_s)) {
          low = low.cwiseMin(p);
          high = high.cwiseMax(p);
        }
    }
    const V size = high - low;
    const std::vector<V> fixed = points(mesh, mesh.parts[0]);
    const auto [tail, nose] = std::minmax_element(
        fixed.begin(), fixed.end(), [](const V& a, const V& b) { return a.x() < b.x(); });
    EXPECT_NEAR(
        nose->x() - tail->x(), airframe.published.length_m, 0.02 * airframe.published.length_m);
    if (airframe.published.span_m > 0) {
      EXPECT_NEAR(size.y(), airframe.published.span_m, 0.02 * airframe.published.span_m);
    }
    EXPECT_NEAR(size.z(), airframe.published.height_m, 0.02 * airframe.published.height_m);
  });
}

// With rotors turning, from the front of the main rotor's disc to the rear of the tail rotor's.
TEST(Airframes, HelicoptersAreAsLongAsPublishedWithRotorsTurning) {
  const std::map<std::string_view, double> published_m = {{"helicopter-light", 11.66},
                                                          {"helicopter-turbine", 12.94},
                                                          {"helicopter-twin", 16.66},
                                                          {"helicopter-tandem", 30.14}};
  for (const auto& [type, length_m] : published_m) {
    double low = 0, high = 0;
    for (const Airframe& airframe : airframes())
      if (airframe.name == type)
        for (const Rotor& rotor : airframe.rotors) {
          low = std::min(low, rotor.hub.forward - rotor.diameter / 2);
          high = std::max(high, rotor.hub.forward + rotor.diameter / 2);
        }
    EXPECT_NEAR(high - low, length_m, 0.02 * length_m) << type;
  }
}

// Every side is passed once in each direction, and the volume is positive: skins are closed, and
// their corners turn counter-clockwise seen from outside.
TEST(Airframes, SkinsAreClosedAndFaceOutwards) {
  each_type([](const Airframe&, const Mesh& mesh) {
    const auto place = [&](std::uint32_t v) {
      const V& p = mesh.positions[v];
      return std::tuple(p.x() + 0.0f, p.y() + 0.0f, p.z() + 0.0f);
    };
    for (const Part& part : mesh.parts) {
      using Point = decltype(place(0));
      std::map<std::pair<Point, Point>, int> passes;
      double six_volumes = 0;
      for (const model::Triangle& t : part.triangles) {
        for (std::size_t k = 0; k < 3; ++k) {
          const Point from = place(t.vertex[k]), to = place(t.vertex[(k + 1) % 3]);
          if (from != to) passes[std::minmax(from, to)] += from < to ? 1 : -1;
        }
        const auto at = [&](std::size_t k) -> Eigen::Vector3d {
          return (mesh.positions[t.vertex[k]] - part.centre_in_body).cast<double>();
        };
        six_volumes += at(0).dot(at(1).cross(at(2)));
      }
      EXPECT_GT(six_volumes, 0) << part.name;
      for (const auto& [side, sum] : passes) ASSERT_EQ(sum, 0) << part.name;
    }
  });
}

TEST(Airframes, NormalsPointAwayFromTheSkin) {
  each_type([](const Airframe&, const Mesh& mesh) {
    int inwards = 0;
    for (const Part& part : mesh.parts)
      for (const model::Triangle& t : part.triangles) {
        const auto& [a, b, c] = t.vertex;
        const V face =
            (mesh.positions[b] - mesh.positions[a]).cross(mesh.positions[c] - mesh.positions[a]);
        const V normal = mesh.normals[a] + mesh.normals[b] + mesh.normals[c];
        if (face.dot(normal) < 0) ++inwards;
      }
    EXPECT_EQ(inwards, 0);
  });
}

// Each paint covers as much on the right as on the left, as far out and as high.
TEST(Airframes, AreSymmetric) {
  each_type([](const Airframe&, const Mesh& mesh) {
    using Sums = std::array<Eigen::Vector4d, 2>;
    std::map<std::uint32_t, Sums> painted;
    for (const model::Triangle& t : mesh.parts[0].triangles) {
      const auto& [a, b, c] = t.vertex;
      const V middle = (mesh.positions[a] + mesh.positions[b] + mesh.positions[c]) / 3;
      if (std::abs(middle.y()) < 1e-3f) continue;
      const V face =
          (mesh.positions[b] - mesh.positions[a]).cross(mesh.positions[c] - mesh.positions[a]);
      const Eigen::Vector4d none = Eigen::Vector4d::Zero();
      Sums& sides = painted.try_emplace(t.material, Sums{none, none}).first->second;
      sides[middle.y() > 0 ? 1 : 0] +=
          0.5 * double(face.norm()) *
          Eigen::Vector4d(1, middle.x(), std::abs(middle.y()), middle.z());
    }
    for (const auto& [material, sides] : painted)
      EXPECT_LT((sides[1] - sides[0]).norm(), 0.01 * sides[0].norm()) << material;
  });
}

// The middle of a blade's tip stands omega t further, and its speed is that of the table.
TEST(Airframes, BladesTurnByTheirSpeed) {
  each_type([](const Airframe& airframe, const Mesh& mesh) {
    for (std::size_t i = 0; i < airframe.rotors.size(); ++i) {
      const Part& part = mesh.parts[i + 1];
      const std::vector<V> before = points(mesh, part);
      const auto far = std::max_element(before.begin(), before.end(), [&](auto& a, auto& b) {
        return (a - part.centre_in_body).norm() < (b - part.centre_in_body).norm();
      });
      constexpr double kTimeS = 1e-3;
      const V after = points(mesh, part, kTimeS)[static_cast<std::size_t>(far - before.begin())];
      const V from = *far - part.centre_in_body, to = after - part.centre_in_body;
      const double angle =
          std::atan2(from.cross(to).dot(part.axis_in_body),
                     from.dot(to) - from.dot(part.axis_in_body) * to.dot(part.axis_in_body));
      const double omega = airframe.rotors[i].tip_mps / (airframe.rotors[i].diameter / 2);
      EXPECT_NEAR(angle, omega * kTimeS, 1e-3 * std::abs(omega * kTimeS)) << part.name;
      EXPECT_LE(model::fastest_turn_per_s(part), 60) << part.name;
    }
  });
}

// Blades of two rotors whose discs overlap never touch.
TEST(Airframes, TandemRotorsPassEachOther) {
  const Mesh mesh = made_mesh("helicopter-tandem/olive");
  const double turn_s = 1 / std::abs(mesh.parts[1].revolutions_per_s);
  for (int step = 0; step < 120; ++step) {
    const double time_s = turn_s * step / 120;
    double nearest_m = 1e9;
    const std::vector<V> others = points(mesh, mesh.parts[2], time_s);
    for (const V& a : points(mesh, mesh.parts[1], time_s))
      for (const V& b : others) nearest_m = std::min<double>(nearest_m, (a - b).norm());
    EXPECT_GT(nearest_m, 0.5) << time_s;
  }
}

TEST(Airframes, NamesAreTypesAndLiveries) {
  const std::vector<std::string> names = made_names();
  EXPECT_TRUE(std::is_sorted(names.begin(), names.end()));
  std::map<std::string, int> liveries;
  for (const std::string& name : names) ++liveries[name.substr(0, name.find('/'))];
  EXPECT_EQ(liveries.size(), airframes().size());
  for (const auto& [type, count] : liveries) EXPECT_GE(count, type == "glider" ? 4 : 5) << type;
  EXPECT_EQ(made_airframe("helicopter-light/pink"), nullptr);
  EXPECT_EQ(made_airframe("helicopter-light"), nullptr);
  EXPECT_NE(made_mesh("helicopter-light/red"), made_mesh("helicopter-light/white"));
}

}  // namespace
}  // namespace airtruth::shapes
