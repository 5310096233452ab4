// SPDX-License-Identifier: Apache-2.0
#include <fstream>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "aircraft/fleet/fleet.h"
#include "aircraft/model/texture.h"
#include "aircraft/wrapper/wrapper.h"
#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "support/error_of.h"

namespace airtruth::fleet {
namespace {

class Models : public testing::Test {
 protected:
  Models()
      : folder_(fs::temp_directory_path() / ("airtruth_aircraft_" + std::to_string(::getpid()))) {
    fs::create_directories(folder_);
  }
  ~Models() override { fs::remove_all(folder_); }
  fs::path folder_;
};

std::string error_of(const std::string& name, const model::LoadOptions& options = {}) {
  return test_support::error_of([&] { load_aircraft(name, options); });
}

// A tetrahedron-like shape with three unequal arms: 10 towards -x (nose), 4
// towards +y (up in AC3D), 2 towards -z (the right wing: x back, y up makes z
// point left).
std::string asymmetric_ac() {
  return "AC3Db\nMATERIAL \"m\" rgb 1 0.5 0 amb 1 1 1 emis 0 0 0 spec 0 0 0 "
         "shi 0 trans 0\nOBJECT "
         "world\nkids 1\n"
         "OBJECT poly\nname \"body\"\nnumvert 4\n0 0 0\n-10 0 0\n0 4 0\n0 0 "
         "-2\nnumsurf 3\n"
         "SURF 0x20\nmat 0\nrefs 3\n0 0 0\n1 0 0\n2 0 0\nSURF 0x20\nmat "
         "0\nrefs 3\n0 0 0\n2 0 0\n3 "
         "0 0\n"
         "SURF 0x20\nmat 0\nrefs 3\n0 0 0\n3 0 0\n1 0 0\nkids 0\n";
}

TEST_F(Models, NoseUpAndRightWingPointWhereTheyShould) {
  write_file(folder_ / "a.ac", asymmetric_ac());
  const model::Extents size = model::extents(load_aircraft((folder_ / "a.ac").string()).mesh);
  EXPECT_TRUE(size.high_in_body.isApprox(Vector3(10, 2, 0))) << size.high_in_body.transpose();
  EXPECT_TRUE(size.low_in_body.isApprox(Vector3(0, 0, -4))) << size.low_in_body.transpose();
  // A byte order mark before the text is none of it.
  write_file(folder_ / "b.ac", "\xEF\xBB\xBF" + asymmetric_ac());
  EXPECT_NEAR(model::extents(load_aircraft((folder_ / "b.ac").string()).mesh).length_m(), 10, 1e-4);
}

TEST_F(Models, TheWrapperLiesAsTheBareFileAndIsShifted) {
  fs::create_directories(folder_ / "AI/Aircraft/t");
  write_file(folder_ / "AI/Aircraft/t/a.ac", asymmetric_ac());
  write_file(folder_ / "AI/Aircraft/t/a.xml",
             "<PropertyList><path>a.ac</path><offsets><x-m>1</x-m><y-m>2</"
             "y-m><z-m>3</z-m></"
             "offsets></PropertyList>");
  const model::Extents size =
      model::extents(load_aircraft((folder_ / "AI/Aircraft/t/a.xml").string()).mesh);
  EXPECT_TRUE(size.high_in_body.isApprox(Vector3(9, 4, -3))) << size.high_in_body.transpose();
}

TEST_F(Models, AnObjFileTakesStatedAxesAndScale) {
  write_file(folder_ / "a.obj", "v 0 0 0\nv 0 5 0\nv 0 0 1\nv 2 0 0\nf 1 2 3\nf 1 2 4\n");
  model::LoadOptions options;
  options.axes = model::ModelAxes{"y", "z", 2};
  const model::Extents size =
      model::extents(load_aircraft((folder_ / "a.obj").string(), options).mesh);
  EXPECT_NEAR(size.high_in_body.x(), 10, 1e-5);  // y is the nose
  EXPECT_NEAR(size.high_in_body.y(), 4, 1e-5);   // x is right
  EXPECT_NEAR(size.low_in_body.z(), -2, 1e-5);   // z is up
  options.axes = model::ModelAxes{"y", "-y", 1};
  EXPECT_THAT(error_of((folder_ / "a.obj").string(), options), testing::HasSubstr("the same axis"));
}

// The disc that stands for a turning propeller is dark and lets nine tenths of the light through,
// whatever the file states. The fan of a jet engine is not such a disc.
TEST_F(Models, APropellersDiscIsFaintAndDark) {
  const auto named = [&](const std::string& name) {
    std::string text = asymmetric_ac();
    text.replace(text.find("body"), 4, name);
    write_file(folder_ / "a.ac", text);
    return load_aircraft((folder_ / "a.ac").string()).mesh.materials.at(0);
  };
  for (const char* disc : {"Prop_Blur_L",
                           "no1propdisk",
                           "Propeller.Fast",
                           "Disk.noshadow",
                           "dh4_blur",
                           "disqueHelice"}) {
    EXPECT_FLOAT_EQ(named(disc).opacity, 0.1f) << disc;
    EXPECT_LT(named(disc).diffuse[0], 0.1f) << disc;
  }
  for (const char* other : {"body",
                            "right_fan_disk",
                            "no2engdisks",
                            "Propeller",
                            "GiroHeliceDEL_02",
                            "ArCanopy-doublure",
                            "Discus-2b",
                            "DISCO"})
    EXPECT_EQ(named(other).opacity, 1) << other;
}

// Of a disc's two sides that a modeller's file has 0.04 mm apart one is drawn; what is a millimetre
// before another surface stays.
TEST_F(Models, TheTwoSidesOfASheetAreOneSurface) {
  const auto triangles_apart = [&](double distance_m) {
    write_file(folder_ / "a.ac",
               fmt::format("AC3Db\nMATERIAL \"m\" rgb 1 1 1 amb 1 1 1 emis 0 0 0 spec 0 0 0 shi 0 "
                           "trans 0\nOBJECT world\nkids 1\nOBJECT poly\nname \"disc\"\n"
                           "numvert 6\n0.39 0 0\n0.39 1 0\n0.39 0 1\n{0} 0 0\n{0} 1 0\n{0} 0 1\n"
                           "numsurf 2\nSURF 0x20\nmat 0\nrefs 3\n0 0 0\n1 0 0\n2 0 0\n"
                           "SURF 0x20\nmat 0\nrefs 3\n5 0 0\n4 0 0\n3 0 0\nkids 0\n",
                           0.39 + distance_m));
    return load_aircraft((folder_ / "a.ac").string()).mesh.parts.at(0).triangles.size();
  };
  for (const double distance_m : {0.0, 1e-6, -4e-5, 4e-5})
    EXPECT_EQ(triangles_apart(distance_m), 1);
  EXPECT_EQ(triangles_apart(1e-3), 2);
}

// A disc's part of the picture counts, not the airframe's: 51 of 255 in its right half.
TEST_F(Models, APropellersDiscMayShareItsPicture) {
  std::string tga("\0\0\2\0\0\0\0\0\0\0\0\0\4\0\1\0\40\10", 18);
  for (const int alpha : {255, 255, 51, 51}) tga += {'\0', '\0', '\0', static_cast<char>(alpha)};
  write_file(folder_ / "skin.tga", tga);
  std::string text =
      "AC3Db\nMATERIAL \"m\" rgb 1 1 1 amb 1 1 1 emis 0 0 0 spec 0 0 0 shi 0 trans 0\n"
      "OBJECT world\nkids 1\nOBJECT poly\nname \"Propeller.Fast\"\n"
      "texture \"skin.tga\"\nnumvert 3\n0 0 0\n0 1 0\n0 0 1\nnumsurf 1\n"
      "SURF 0x20\nmat 0\nrefs 3\n0 0.6 0.1\n1 0.9 0.1\n2 0.7 0.9\nkids 0\n";
  write_file(folder_ / "a.ac", text);
  const auto mesh = load_aircraft((folder_ / "a.ac").string()).mesh;
  EXPECT_FLOAT_EQ(mesh.materials.at(0).opacity, 0.1f / 0.2f);
}

// Whatever its name, a part that turns and whose own texels are faint (51 of 255, a fifth) stands
// for turning blades. One at rest keeps its picture, and blades that turn are opaque.
TEST_F(Models, AFaintPartThatTurnsIsAPropellersDisc) {
  fs::create_directories(folder_ / "AI/Aircraft/t");
  const auto opacity = [&](int alpha, const std::string& animation) {
    std::string tga("\0\0\2\0\0\0\0\0\0\0\0\0\1\0\1\0\40\10", 18);
    tga += {'\0', '\0', '\0', static_cast<char>(alpha)};
    write_file(folder_ / "AI/Aircraft/t/skin.tga", tga);
    std::string text = asymmetric_ac();
    text.replace(text.find("numvert"), 0, "texture \"skin.tga\"\n");
    text.replace(text.find("1 0 0\n2 0 0"), 11, "1 1 0\n2 0 1");
    write_file(folder_ / "AI/Aircraft/t/a.ac", text);
    write_file(folder_ / "AI/Aircraft/t/a.xml",
               "<PropertyList><path>a.ac</path><animation><type>" + animation +
                   "</type><object-name>body</object-name><property>engines/engine[0]/rpm"
                   "</property><axis><x>1</x></axis></animation></PropertyList>");
    return load_aircraft((folder_ / "AI/Aircraft/t/a.xml").string()).mesh.materials.at(0).opacity;
  };
  EXPECT_FLOAT_EQ(opacity(51, "spin"), 0.1f / 0.2f);
  EXPECT_EQ(opacity(51, "noshadow"), 1);
  EXPECT_EQ(opacity(255, "spin"), 1);
}

TEST_F(Models, SelectRotateAndSpinAreHonoured) {
  fs::create_directories(folder_ / "AI/Aircraft/t");
  write_file(folder_ / "AI/Aircraft/t/a.ac", asymmetric_ac());
  const auto with = [&](const std::string& animation) {
    write_file(folder_ / "AI/Aircraft/t/a.xml",
               "<PropertyList><path>a.ac</path>" + animation + "</PropertyList>");
    return (folder_ / "AI/Aircraft/t/a.xml").string();
  };
  const std::string hide =
      "<animation><type>select</type><object-name>body</"
      "object-name><condition><less-than>"
      "<property>velocities/true-airspeed-kt</property><value>180</value></"
      "less-than></condition></"
      "animation>";
  EXPECT_THAT(error_of(with(hide), {.airspeed_kt = 250}), testing::HasSubstr("no triangles"));
  EXPECT_EQ(load_aircraft(with(hide), {.airspeed_kt = 100}).mesh.triangle_count(), 3u);
  const std::string spin =
      "<animation><type>spin</type><object-name>body</"
      "object-name><property>engines/engine[0]/rpm</"
      "property>"
      "<center><x-m>-10</x-m></center><axis><x>1</x></axis></animation>";
  const model::Mesh mesh = load_aircraft(with(spin)).mesh;
  ASSERT_EQ(mesh.parts.size(), 2u);
  EXPECT_TRUE(mesh.parts[1].spins);
  EXPECT_TRUE(mesh.parts[1].centre_in_body.isApprox(Eigen::Vector3f(10, 0, 0)));
  EXPECT_NEAR(mesh.parts[1].revolutions_per_s, 2300.0 / 60, 1e-9);
  const std::string rotate =
      "<animation><type>rotate</type><object-name>body</"
      "object-name><offset-deg>90</"
      "offset-deg><axis><z>1</z></axis></animation>";
  // A quarter turn about up, right-handed: the nose goes from forward to the
  // right (x back, y right, z up).
  EXPECT_NEAR(model::extents(load_aircraft(with(rotate)).mesh).low_in_body.y(), -10, 1e-4);
}

// What stands on the ground is left out by a whole word of its name, and a shock strut is not.
TEST_F(Models, WheelChocksDoNotFly) {
  const auto named = [&](const std::string& name) {
    std::string text = asymmetric_ac();
    text.replace(text.find("body"), 4, name);
    write_file(folder_ / "a.ac", text);
    return (folder_ / "a.ac").string();
  };
  for (const char* chock : {"Chocks-Left", "nose_chock", "WheelChocks.001"})
    EXPECT_THAT(error_of(named(chock)), testing::HasSubstr("no triangles")) << chock;
  EXPECT_EQ(load_aircraft(named("UC-NLowerSchock")).mesh.triangle_count(), 3u);
}

// Nested models are effects by whole words of their path, below the aircraft's own folder.
TEST_F(Models, ANestedPartIsAnEffectByWholeWordsOfItsPath) {
  const auto triangles = [&](const std::string& part) {
    fs::create_directories((folder_ / part).parent_path());
    write_file(folder_ / part, asymmetric_ac());
    write_file(folder_ / "body.ac", asymmetric_ac());
    write_file(folder_ / "w.xml",
               "<PropertyList><path>body.ac</path><model><path>" + part +
                   "</path><offsets><x-m>20</x-m></offsets></model></PropertyList>");
    return load_aircraft((folder_ / "w.xml").string()).mesh.triangle_count();
  };
  for (const char* part : {"FlightSurfaces/wing.ac",
                           "Aircraft/UltraLight-Trike/Models/wing.ac",
                           "Terrain/wing.ac",
                           "smokewinder.ac"})
    EXPECT_EQ(triangles(part), 6U) << part;
  for (const char* lamp : {"Lights/green.ac",
                           "Aircraft/trike/Models/NavLights.ac",
                           "landinglight.ac",
                           "StrobeWhite.ac",
                           "Models/Effects/dust.ac",
                           "contrail1.ac"})
    EXPECT_EQ(triangles(lamp), 3U) << lamp;
}

// A helicopter's file holds every blade in one place, and the flight model turns blade k of n to
// 360 k / n degrees: with two blades that point aft (x back), one stays and one points forward.
TEST_F(Models, TheBladesOfARotorStandEvenlyAboutIt) {
  fs::create_directories(folder_ / "AI/Aircraft/t");
  const auto turned = [](const std::string& property) {
    return "<animation><type>rotate</type><object-name>body</object-name><property>" + property +
           "</property><axis><z>1</z></axis></animation>";
  };
  const auto low_x = [&](const std::string& animations) {
    write_file(folder_ / "AI/Aircraft/t/a.ac", asymmetric_ac());
    write_file(folder_ / "AI/Aircraft/t/a.xml",
               "<PropertyList><path>a.ac</path>" + animations + "</PropertyList>");
    return model::extents(load_aircraft((folder_ / "AI/Aircraft/t/a.xml").string()).mesh)
        .low_in_body;
  };
  const std::string last =
      "<animation><type>rotate</type><object-name>none</object-name>"
      "<property>rotors/main/blade[3]/position-deg</property></animation>";
  // The arm of 10 m points forward; blade 1 of 4 takes it to the right-handed side, -y in body.
  EXPECT_NEAR(low_x(turned("rotors/main/blade[1]/position-deg") + last).y(), -10, 1e-4);
  EXPECT_NEAR(low_x(turned("/rotors/main/blade[2]/position-deg") + last).x(), -10, 1e-4);
  // A rotor of its own, the first blade and other properties stay at rest.
  EXPECT_NEAR(low_x(turned("rotors/tail/blade[0]/position-deg") + last).x(), 0, 1e-4);
  EXPECT_NEAR(low_x(turned("rotors/main/blade[2]/flap-deg") + last).x(), 0, 1e-4);
}

TEST_F(Models, SaysWhatIsWrong) {
  EXPECT_THAT(error_of("738/738-Ryanar"), testing::HasSubstr("738/738-Ryanair"));
  EXPECT_THAT(error_of((folder_ / "none.ac").string()), testing::HasSubstr("does not exist"));
  write_file(folder_ / "t.ac",
             "AC3Db\nMATERIAL \"m\" rgb 1 1 1 amb 1 1 1 emis 0 0 0 spec 0 0 0 "
             "shi 0 trans "
             "0\nOBJECT world\nkids 1\n"
             "OBJECT poly\ntexture \"gone.png\"\nnumvert 3\n0 0 0\n1 0 0\n0 1 "
             "0\nnumsurf 1\nSURF 0x20\nmat 0\n"
             "refs 3\n0 0 0\n1 0 0\n2 0 0\nkids 0\n");
  EXPECT_THAT(error_of((folder_ / "t.ac").string()),
              testing::HasSubstr("t.ac:6: wants the texture gone.png"));
  write_file(folder_ / "e.ac", "AC3Db\nOBJECT world\nkids 0\n");
  EXPECT_THAT(error_of((folder_ / "e.ac").string()), testing::HasSubstr("e.ac: "));
  write_file(folder_ / "g.ac", "garbage");
  EXPECT_THAT(error_of((folder_ / "g.ac").string()), testing::HasSubstr("no AC3D file"));
}

TEST(Texture, DecodesPremultipliesAndAverages) {
  const model::Texture texture =
      model::texture_from_picture({2, 1, {255, 255, 255, 255, 128, 128, 128, 128}}, true, true);
  constexpr float kAlpha = 128.0f / 255;
  EXPECT_TRUE(texture.has_translucency);
  const model::Texel second = model::kDecoding.texel(model::finest_bytes(texture, 1, 0));
  EXPECT_NEAR(second[0], kAlpha * 0.2158605f, 1e-5f);  // 128 decoded
  ASSERT_EQ(texture.coarser.size(), 1u);
  EXPECT_NEAR(texture.coarser[0].texels[0][3], 0.5f * (1 + kAlpha), 1e-6f);
}

// Boeing's published figures for the 737-800 with winglets: 39.5 m long, 35.8 m
// span, 12.5 m high on its wheels.
TEST(Catalogue, TheRyanair737HasABoeing737sSize) {
  const Aircraft aircraft = load_aircraft("738/738-Ryanair", {.airspeed_kt = 270});
  const model::Extents size = model::extents(aircraft.mesh);
  EXPECT_NEAR(size.length_m(), 39.5, 0.8);
  EXPECT_NEAR(size.span_m(), 35.8, 1.2);
  EXPECT_GT(size.height_m(), 9);
  EXPECT_LT(size.height_m(), 12.6);
  EXPECT_NEAR(static_cast<double>(aircraft.mesh.triangle_count()), 2996, 900);
  // The fin is aft and high: the highest point of all lies in the last fifth.
  double fin_x = 0;
  double top = 1e9;
  for (const auto& part : model::silhouette_points(aircraft.mesh))
    for (const auto& p : part)
      if (p.z() < top) top = p.z(), fin_x = p.x();
  EXPECT_LT(fin_x, size.low_in_body.x() + 0.25 * size.length_m());
}

// The file of the model has a span of 9.63 m (wing vertices from z = -4.82 to 4.81). Cessna's
// handbook states 11.00 m.
TEST(Catalogue, TheCessnaIsBroughtToItsPublishedSpan) {
  const Aircraft as_it_is = load_aircraft("c172/news", {.airspeed_kt = 110, .catalogue_scale = 1});
  EXPECT_NEAR(model::extents(as_it_is.mesh).length_m(), 8.2, 0.6);
  EXPECT_NEAR(model::extents(as_it_is.mesh).span_m(), 9.63, 0.02);
  const Aircraft scaled = load_aircraft("c172/news", {.airspeed_kt = 110});
  EXPECT_NEAR(model::extents(scaled.mesh).span_m(), 11.00, 1e-3);
  EXPECT_NEAR(scaled.catalogue_scale, 11.00 / 9.63, 0.003);
  EXPECT_THAT(error_of("a.ac", {.catalogue_scale = 2}), testing::HasSubstr("a.ac"));
}

TEST(Catalogue, ListsHundredsAndTheirLiveries) {
  const auto entries = list_aircraft();
  EXPECT_GT(entries.size(), 900u);
  EXPECT_THAT(liveries("738/738-Ryanair"), testing::Contains("738/738-KLM"));
}

// A name that is made in code needs no file, and stands in the list beside those of packages.
TEST(Catalogue, HoldsWhatIsMadeInCode) {
  const Aircraft made = load_aircraft("helicopter-twin/rescue");
  EXPECT_TRUE(made.sources.empty());
  EXPECT_EQ(made.catalogue_scale, 1);
  EXPECT_EQ(made.mesh.parts.size(), 3U);
  EXPECT_EQ(liveries("helicopter-twin/rescue").size(), 5U);
  EXPECT_EQ(aircraft_fitting("helicopter-*").size(), 24U);
  EXPECT_EQ(configuration_of("glider/white", {}), "");
  EXPECT_NEAR(
      model::extents(load_aircraft("glider/white", {.catalogue_scale = 2}).mesh).span_m(), 34, 0.1);
  EXPECT_THAT(error_of("helicopter-twin/rescu"), testing::HasSubstr("helicopter-twin/rescue"));
}

TEST(Catalogue, APatternIsNoNameAndSaysWhatItFits) {
  EXPECT_THAT(error_of("helicopter-t*"),
              testing::AllOf(testing::HasSubstr("'helicopter-t*' is a pattern"),
                             testing::HasSubstr("such as helicopter-tandem/blue"),
                             testing::HasSubstr("shows 18")));
  EXPECT_THAT(error_of("helicopter-q*"), testing::HasSubstr("unknown aircraft 'helicopter-q*'"));
}

// The ending of the name, in upper or lower case, decides before the catalogue is searched.
TEST(AircraftFile, AModelFileIsItselfAndAnythingElseIsACatalogueName) {
  const fs::path file = fs::path(testing::TempDir()) / "plane.OBJ";
  std::ofstream(file) << "v 0 0 0\n";
  EXPECT_EQ(aircraft_file(file.string()), file);
  fs::remove(file);
  EXPECT_EQ(aircraft_file("738/738-Ryanair").filename(), "738-Ryanair.xml");
  const auto message = [](const std::string& name) -> std::string {
    try {
      return aircraft_file(name).string();
    } catch (const Error& error) {
      return error.what();
    }
  };
  EXPECT_THAT(message(file.string()), testing::HasSubstr("plane.OBJ' does not exist"));
  EXPECT_THAT(message("738/738-Ryanaire"), testing::HasSubstr("738/738-Ryanair"));
}

}  // namespace
}  // namespace airtruth::fleet
