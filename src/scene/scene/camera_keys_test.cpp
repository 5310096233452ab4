// SPDX-License-Identifier: Apache-2.0
#include "scene/scene/camera_keys.h"

#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "foundation/base/files.h"
#include "foundation/base/text.h"
#include "support/source_folder.h"

// The table of keys against what is outside it: the struct, the files that read the members, the
// document, and the text of scenes.
namespace airtruth::scene {
namespace {

const fs::path kSource = test_support::source_folder();

std::string type_of(const CameraKey& key) {
  if (std::holds_alternative<CameraKey::Number>(key.member)) return "number";
  return std::holds_alternative<CameraKey::Colour>(key.member) ? "[r, g, b]" : "string";
}

std::string range_of(const CameraKey& key) {
  if (!std::holds_alternative<CameraKey::Direction>(key.member))
    return fmt::format("{} to {}", key.limits.low, key.limits.high);
  std::string words;
  for (const std::string& word : all_enum_names<Readout>())
    words += (words.empty() ? "`" : ", `") + word + "`";
  return words;
}

// A row of the document's table without its unit, its meaning, and how the quantity is measured.
std::string row_of(const CameraKey& key) {
  return fmt::format("[{}] `{}` {} {} {}",
                     key.table(),
                     key.key(),
                     type_of(key),
                     range_of(key),
                     key.is_measured ? "measured" : "never");
}

TEST(CameraKeys, EveryFieldOfTheModelHasARow) {
  // A new field of CameraModel breaks this binding; it then needs a row of its own.
  const CameraModel model;
  [[maybe_unused]] const auto& [a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, automatic] = model;
  EXPECT_EQ(kCameraModelKeys.size(), 16u);
  std::set<const void*> members;
  for (const CameraKey& key : kCameraModelKeys)
    std::visit([&](auto member) { members.insert(&(model.*member)); }, key.member);
  EXPECT_EQ(members.size(), kCameraModelKeys.size());
}

TEST(CameraKeys, TheTableOfSceneMdIsThatOfTheProgram) {
  const std::string document = read_file(kSource / "docs/formats/scene.md");
  std::istringstream lines(
      document.substr(document.find("<!-- begin: rows of src/scene/scene/camera_keys.h -->\n")));
  std::string line;
  for (int i = 0; i < 3; ++i) std::getline(lines, line);  // the mark, the header and its rule
  for (const CameraKey& key : kCameraModelKeys) {
    ASSERT_TRUE(std::getline(lines, line));
    std::vector<std::string> cells;
    std::istringstream row(line);
    for (std::string cell; std::getline(row, cell, '|');) cells.emplace_back(trimmed(cell));
    ASSERT_EQ(cells.size(), 8u) << line;
    EXPECT_EQ(fmt::format("{} {} {} {} {}",
                          cells[1],
                          cells[2],
                          cells[3],
                          cells[5],
                          cells[6] == "never" ? "never" : "measured"),
              row_of(key));
  }
  std::getline(lines, line);
  EXPECT_EQ(line, "<!-- end -->");
}

TEST(CameraKeys, RenderingReadsEveryMember) {
  std::string text;
  for (const char* file :
       {"setup/from_scene.cpp", "pipeline/resolved_scene.cpp", "insertion/paint.cpp"})
    text += read_file(kSource / "src/sequence" / file);
  for (const CameraKey& key : kCameraModelKeys)
    EXPECT_NE(text.find("." + std::string(key.key())), std::string::npos) << key.name;
}

// A scene with one key of a camera model.
Scene scene_with(const CameraKey& key, const std::string& value) {
  return parse_scene(fmt::format("[background]\nvideo = \"clip.mp4\"\n[lens]\nvertical_fov_deg = "
                                 "60\n[{}]\n{} = {}\n",
                                 key.table(),
                                 key.key(),
                                 value),
                     "/data/a.toml");
}

std::string message_of(const CameraKey& key, const std::string& value) {
  try {
    scene_with(key, value);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(CameraKeys, RangesHoldAndAutoIsForWhatIsMeasured) {
  for (const CameraKey& key : kCameraModelKeys) {
    EXPECT_EQ(message_of(key, "\"auto\"").empty(), key.is_measured) << key.name;
    if (key.is_measured) {
      EXPECT_EQ(scene_with(key, "\"auto\"").camera_model.automatic,
                std::vector<std::string>{key.name});
    }
    if (!std::holds_alternative<CameraKey::Number>(key.member)) continue;
    EXPECT_EQ(message_of(key, fmt::format("{}", key.limits.high)), "") << key.name;
    EXPECT_NE(
        message_of(key, fmt::format("{}", key.limits.high + 1))
            .find(fmt::format(
                "{} is {}; expected {}", key.key(), key.limits.high + 1, key.limits.expected)),
        std::string::npos)
        << key.name;
  }
}

TEST(CameraKeys, AKeyThatExcludesAnotherSaysSo) {
  EXPECT_NE(message_of(*camera_key("shutter.angle_deg"), "180\nexposure_s = 0.01")
                .find("exposure_s and angle_deg exclude each other"),
            std::string::npos);
}

TEST(CameraKeys, AnEffectNeedsAValueAboveZero) {
  const CameraKey& haze = *camera_key("air.extinction_per_km");
  CameraModel model;
  EXPECT_FALSE(is_above_zero(model, haze));
  EXPECT_FALSE(states_any_key(model));
  model.extinction_per_km = {{0, 0, 0}};
  EXPECT_FALSE(is_above_zero(model, haze));
  EXPECT_TRUE(states_any_key(model));
  model.extinction_per_km = {{0, 0.1, 0}};
  EXPECT_TRUE(is_above_zero(model, haze));
}

TEST(CameraKeys, ThirteenCanBeMeasured) {
  CameraModel model;
  int count = 0;
  const auto visit = [&](const char* name, const auto&) {
    EXPECT_TRUE(camera_key(name)->is_measured);
    ++count;
  };
  for_each_camera_key(visit, model);
  EXPECT_EQ(count, 13);
  EXPECT_EQ(camera_key("sensor.codec_steps"), nullptr);
}

TEST(CameraKeys, AMisspelledChoiceNamesTheNearest) {
  try {
    scene_with(*camera_key("shutter.readout"), "\"rigth\"");
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what())
                  .find("readout is 'rigth'; expected down, up, right or left; did you mean "
                        "'right'?"),
              std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace airtruth::scene
