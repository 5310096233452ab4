// SPDX-License-Identifier: Apache-2.0
#include "aircraft/fleet/scale.h"

#include <cmath>
#include <map>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "aircraft/fleet/fleet.h"
#include "foundation/base/error.h"
#include "foundation/geometry/units.h"

namespace airtruth::fleet {
namespace {

model::Extents extents_of(double span_m, double length_m) {
  model::Extents extents;
  extents.high_in_body = {length_m / 2, span_m / 2, 1};
  extents.low_in_body = {-length_m / 2, -span_m / 2, 0};
  return extents;
}

// Cessna's handbook of the 172P: 36 ft 1 in (11.00 m) across, 27 ft 2 in (8.28 m) long.
TEST(Scale, IsCorrectedWhereSpanAndLengthAgreeThatItIsOff) {
  const PublishedSize* cessna = published_size("c172/news");
  ASSERT_NE(cessna, nullptr);
  EXPECT_NEAR(cessna->span_m, 36 * kMetresOfFoot + 0.0254, 0.01);
  EXPECT_NEAR(cessna->length_m, 27 * kMetresOfFoot + 2 * 0.0254, 0.01);
  EXPECT_NEAR(scale_to_published(extents_of(9.63, 7.77), *cessna), 11.00 / 9.63, 1e-12);
  EXPECT_EQ(scale_to_published(extents_of(9.63, 8.28), *cessna), 1);   // the length is right
  EXPECT_EQ(scale_to_published(extents_of(9.63, 9.00), *cessna), 1);   // too narrow and too long
  EXPECT_EQ(scale_to_published(extents_of(10.75, 8.00), *cessna), 1);  // 2.3 %
  EXPECT_NEAR(scale_to_published(extents_of(22, 16.56), *cessna), 0.5, 1e-12);
}

TEST(Scale, MovesPropellersWithTheirAircraft) {
  model::Mesh mesh;
  mesh.positions = {{1, 2, 3}, {-1, 0, 4}};
  mesh.normals = {{0, 0, 1}, {0, 1, 0}};
  model::Part propeller;
  propeller.centre_in_body = {2, 0, -1};
  propeller.axis_in_body = {1, 0, 0};
  mesh.parts = {model::Part{}, propeller};
  scale_mesh(mesh, 1.5);
  EXPECT_EQ(mesh.positions[0], Eigen::Vector3f(1.5F, 3, 4.5F));
  EXPECT_EQ(mesh.normals[1], Eigen::Vector3f(0, 1, 0));
  EXPECT_EQ(mesh.parts[1].centre_in_body, Eigen::Vector3f(3, 0, -1.5F));
  EXPECT_EQ(mesh.parts[1].axis_in_body, Eigen::Vector3f(1, 0, 0));
}

TEST(Scale, TheTableIsWholeAndNamesItsSources) {
  std::set<std::string> patterns;
  ASSERT_GT(published_sizes().size(), 90u);
  for (const PublishedSize& size : published_sizes()) {
    EXPECT_FALSE(size.type.empty());
    for (const std::string& pattern : size.names)
      EXPECT_TRUE(patterns.insert(pattern).second) << pattern << " stands twice";
    if (!size.is_known()) continue;
    EXPECT_FALSE(size.source.empty()) << size.type;
    EXPECT_GT(size.span_m, 4) << size.type;
    EXPECT_LT(size.span_m, 80) << size.type;
    // The proportions of the Starfighter and of the Cri-Cri are the extremes of all types.
    EXPECT_GT(size.span_m / size.length_m, 0.4) << size.type;
    EXPECT_LT(size.span_m / size.length_m, 2.5) << size.type;
  }
  EXPECT_FALSE(published_size("Ferry/FerryBoat1")->is_known());
  EXPECT_EQ(published_size("nosuch/one"), nullptr);
}

// Loads one aircraft per row. Where the span is still wrong after the correction, the length must
// contradict an error of scale.
TEST(Scale, EveryInstalledTypeIsAsLargeAsPublishedOrSaysWhyNot) {
  std::map<const PublishedSize*, std::string> one_of;
  for (const Entry& entry : list_aircraft())
    if (const PublishedSize* size = published_size(entry.name); size != nullptr && size->is_known())
      one_of.emplace(size, entry.name);
  ASSERT_GT(one_of.size(), 80u);
  std::size_t loaded = 0;
  std::vector<std::string> corrected;
  for (const auto& [size, name] : one_of) {
    try {
      const Aircraft aircraft = load_aircraft(name);
      const model::Extents extents = model::extents(aircraft.mesh);
      const SizeError error = size_error(extents, *size);
      ++loaded;
      if (aircraft.catalogue_scale != 1) {
        corrected.push_back(size->type);
        EXPECT_NEAR(error.span, 0, 1e-6) << name;
      }
      EXPECT_EQ(scale_to_published(extents, *size), 1) << name;
      const std::string words = size_words(extents, aircraft.catalogue_scale, size);
      EXPECT_EQ(words.find("not to scale") != std::string::npos,
                std::abs(error.span) > 0.03 || std::abs(error.length) > 0.03)
          << words;
    } catch (const Error& error) {  // parts that the package does not install
      std::printf("%s: %s\n", name.c_str(), error.what());
    }
  }
  EXPECT_GT(loaded, 80u);
  EXPECT_THAT(corrected, testing::IsSupersetOf({"Cessna 172P", "de Havilland Canada Dash 7"}));
  for (const std::string& type : corrected) std::printf("corrected: %s\n", type.c_str());
}

}  // namespace
}  // namespace airtruth::fleet
