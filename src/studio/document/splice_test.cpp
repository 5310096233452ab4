// SPDX-License-Identifier: Apache-2.0
#include "studio/document/splice.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "foundation/base/error.h"
#include "studio/document/tree.h"
#include "support/error_of.h"

namespace airtruth::document {
namespace {

using testing::HasSubstr;

std::string with(const std::string& text, const std::string& change) {
  return changed(text, change_from(nlohmann::ordered_json::parse(change), "change"), "a.toml");
}
std::string message(const std::string& text, const std::string& change) {
  return test_support::error_of([&] { with(text, change); });
}

const std::string kScene =
    "# Over the lake.\n"
    "[background]\n"
    "video = \"clip.mp4\"   # 30 s\n"
    "\n"
    "[lens]\n"
    "vertical_fov_deg = 60  # a guess\n"
    "\n"
    "# The first one.\n"
    "[[intruder]]\n"
    "id = \"a\"\n"
    "\n"
    "  [[intruder.seen]]\n"
    "  time_s = 1.0\n"
    "  pixel = [ 10, # from the left\n"
    "            20 ]\n"
    "  range_m = 900\n"
    "  [[intruder.seen]]\n"
    "  time_s = 2.0\n"
    "  pixel = [30, 40]\n"
    "  range_m = 800\n"
    "  # nearer still later\n"
    "\n"
    "# The second one.\n"
    "[[intruder]]\n"
    "id = \"b\" # no more";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

TEST(Splice, AValueChangesWhereItStands) {
  EXPECT_EQ(with(kScene, R"({"set":["lens","vertical_fov_deg"],"to":61.5})"),
            replaced(kScene, "60 ", "61.5 "));
  EXPECT_EQ(with(kScene, R"({"set":["background","video"],"to":"a \"b\"\\.mp4"})"),
            replaced(kScene, "\"clip.mp4\"", R"("a \"b\"\\.mp4")"));
  EXPECT_EQ(with(kScene, R"({"set":["intruder",0,"seen",1,"pixel"],"to":[30.25,288.0]})"),
            replaced(kScene, "[30, 40]", "[30.25, 288]"));
}

TEST(Splice, AnArrayOfTheSameLengthKeepsItsComments) {
  EXPECT_EQ(with(kScene, R"({"set":["intruder",0,"seen",0,"pixel"],"to":[11.1234567,20]})"),
            replaced(kScene, "[ 10, #", "[ 11.123457, #"));
}

TEST(Splice, ANewKeyStandsBehindTheLastOfItsTable) {
  EXPECT_EQ(with(kScene, R"({"set":["lens","model"],"to":"pinhole"})"),
            replaced(kScene, "a guess\n", "a guess\nmodel = \"pinhole\"\n"));
  EXPECT_EQ(with(kScene, R"({"set":["intruder",0,"seen",0,"width_px"],"to":3})"),
            replaced(kScene, "  range_m = 900\n", "  range_m = 900\n  width_px = 3\n"));
  EXPECT_EQ(with(kScene, R"({"set":["intruder",0,"aircraft"],"to":"c172"})"),
            replaced(kScene, "id = \"a\"\n", "id = \"a\"\naircraft = \"c172\"\n"));
  EXPECT_EQ(with(kScene, R"({"set":["intruder",1,"roll_deg"],"to":-0.5})"),
            kScene + "\nroll_deg = -0.5\n");
  EXPECT_EQ(with(kScene, R"({"set":["seed"],"to":7})"), "seed = 7\n\n" + kScene);
}

TEST(Splice, ANewTableStandsAtTheEndOfWhatItBelongsTo) {
  EXPECT_EQ(with(kScene, R"({"set":["light","sun_azimuth_deg"],"to":90})"),
            kScene + "\n\n[light]\nsun_azimuth_deg = 90\n");
  EXPECT_EQ(with(kScene, R"({"insert":["intruder",1,"seen"],"at":0,"table":{"time_s":1}})"),
            kScene + "\n\n[[intruder.seen]]\ntime_s = 1\n");
  EXPECT_EQ(
      with("a = 1\n", R"({"insert":["intruder"],"at":null,"table":{"id":"x","seen":[
      {"time_s":1,"pixel":[1,2]},{"time_s":2,"pixel":[3,4]}],"n":[1.50]}})"),
      "a = 1\n\n[[intruder]]\nid = \"x\"\nn = [1.5]\n\n[[intruder.seen]]\ntime_s = 1\npixel = "
      "[1, 2]\n\n[[intruder.seen]]\ntime_s = 2\npixel = [3, 4]\n");
}

TEST(Splice, AnElementStandsAtItsPlace) {
  EXPECT_EQ(
      with(kScene, R"({"insert":["intruder",0,"seen"],"at":1,"table":{"time_s":1.5,"range_m":1}})"),
      replaced(kScene,
               "  range_m = 900\n",
               "  range_m = 900\n  [[intruder.seen]]\n  time_s = 1.5\n  range_m = 1\n\n"));
  EXPECT_EQ(
      with(kScene, R"({"insert":["intruder"],"at":1,"table":{"id":"c"}})"),
      replaced(kScene, "# The second one.\n", "[[intruder]]\nid = \"c\"\n\n# The second one.\n"));
}

TEST(Splice, WhatIsRemovedTakesItsLinesWithIt) {
  EXPECT_EQ(with(kScene, R"({"remove":["lens","vertical_fov_deg"]})"),
            replaced(kScene, "vertical_fov_deg = 60  # a guess\n", ""));
  EXPECT_EQ(with(kScene, R"({"remove":["intruder",0,"seen",1]})"),
            replaced(kScene,
                     "  [[intruder.seen]]\n  time_s = 2.0\n  pixel = [30, 40]\n  range_m = 800\n",
                     ""));
  EXPECT_EQ(with(kScene, R"({"remove":["intruder",1]})"),
            replaced(kScene, "[[intruder]]\nid = \"b\" # no more", ""));
  const std::string one = with(kScene, R"({"remove":["intruder",0]})");
  EXPECT_THAT(one, HasSubstr("# The first one.\n  # nearer still later\n"));
  EXPECT_EQ(tree_of(one, "").values["intruder"].size(), 1u);
}

TEST(Splice, InlineTablesAndArraysAreChangedInTheirLine) {
  const std::string text =
      "seen = [{ t = 1, p.x = 3 }, {t = 2,}, ] # c\nempty = {}\nnone = []\n"
      "list = [ 1, # one\n  2, # two\n  3 # three\n]\n";
  // A comma behind the last key is no TOML.
  const std::string good = replaced(text, "2,}", "2}");
  EXPECT_THAT(message(text, R"({"remove":["empty"]})"), HasSubstr("is not TOML"));
  EXPECT_EQ(with(good, R"({"set":["seen",0,"t"],"to":5})"), replaced(good, "t = 1", "t = 5"));
  EXPECT_EQ(with(good, R"({"set":["seen",1,"q"],"to":"z"})"),
            replaced(good, "t = 2", "t = 2, q = \"z\""));
  EXPECT_EQ(with(good, R"({"set":["empty","q"],"to":true})"), replaced(good, "{}", "{ q = true }"));
  EXPECT_EQ(with(good, R"({"remove":["seen",0]})"), replaced(good, "{ t = 1, p.x = 3 }, ", ""));
  EXPECT_EQ(with(good, R"({"remove":["seen",0,"t"]})"), replaced(good, "t = 1, ", ""));
  EXPECT_EQ(with(good, R"({"insert":["seen"],"at":1,"table":{"t":4}})"),
            replaced(good, "{t = 2}", "{ t = 4 }, {t = 2}"));
  EXPECT_EQ(with(good, R"({"insert":["seen"],"table":{"t":4}})"),
            replaced(good, "{t = 2}", "{t = 2}, { t = 4 }"));
  EXPECT_EQ(with(good, R"({"insert":["none"],"table":{"t":4}})"),
            replaced(good, "[]", "[{ t = 4 }]"));
  EXPECT_EQ(with(good, R"({"remove":["list",1]})"), replaced(good, "2, # two", "# two"));
  EXPECT_EQ(with(good, R"({"remove":["list",2]})"),
            replaced(replaced(good, "2, # two", "2 # two"), "3 # three", " # three"));
}

TEST(Splice, DottedKeysStayDotted) {
  const std::string text = "lens.model = 'fisheye' # m\nlens . focal_px = [1,2]\n[a.b]\nx=1\n";
  EXPECT_EQ(with(text, R"({"set":["lens","model"],"to":"pinhole"})"),
            replaced(text, "'fisheye'", "\"pinhole\""));
  EXPECT_EQ(with(text, R"({"set":["lens","vertical_fov_deg"],"to":50})"),
            replaced(text, "[1,2]\n", "[1,2]\nlens . vertical_fov_deg = 50\n"));
  EXPECT_EQ(with(text, R"({"remove":["lens"]})"), "[a.b]\nx=1\n");
  EXPECT_EQ(with(text, R"({"set":["a","y"],"to":2})"), text + "\n[a]\ny = 2\n");
  EXPECT_EQ(with(text, R"({"set":["a","b","y"],"to":2})"), text + "y = 2\n");
}

TEST(Splice, LinesEndAsTheFileEndsThem) {
  const std::string text =
      "\xEF\xBB\xBFname = \"\xC3\xA4\" # \xC3\xB6\r\n[lens]\r\nx = \"\xC3\xA4\" # y\r\n";
  EXPECT_EQ(with(text, R"({"set":["lens","x"],"to":1})"),
            replaced(text, "\"\xC3\xA4\" # y", "1 # y"));
  EXPECT_EQ(with(text, R"({"set":["lens","z"],"to":1})"), text + "z = 1\r\n");
  EXPECT_EQ(with(text, R"({"set":["name"],"to":"b"})"),
            replaced(text, "\"\xC3\xA4\" # \xC3\xB6", "\"b\" # \xC3\xB6"));
  EXPECT_EQ(with(text, R"({"set":["light"],"to":{"a":1}})"), text + "\r\n[light]\r\na = 1\r\n");
  EXPECT_EQ(with("", R"({"set":["a"],"to":1})"), "a = 1\n");
}

TEST(Splice, StringsOfSeveralLinesAreNoHeaders) {
  const std::string text = "[a]\nt = \"\"\"\n[[a]]\nx = 1\n\"\"\" # c\nx = 2\n";
  EXPECT_EQ(with(text, R"({"set":["a","x"],"to":3})"), replaced(text, "x = 2", "x = 3"));
  EXPECT_EQ(with(text, R"({"remove":["a","t"]})"), "[a]\nx = 2\n");
}

TEST(Splice, ATableOfKeysIsSetKeyByKey) {
  EXPECT_EQ(with("[lens] # l\na = 1 # x\nb = 2\n", R"({"set":["lens"],"to":{"a":3,"c":4}})"),
            "[lens] # l\na = 3 # x\nc = 4\n");
}

TEST(Splice, NumbersAreWrittenAsAPersonWould) {
  const auto written = [](double value) { return toml_of(value); };
  EXPECT_EQ(written(613.2), "613.2");
  EXPECT_EQ(written(288.0), "288");
  EXPECT_EQ(written(0.1 + 0.2), "0.3");
  EXPECT_EQ(written(-0.0), "0");
  EXPECT_EQ(written(1.0 / 3), "0.333333");
  EXPECT_EQ(written(1.25e-5), "1.25e-05");
  EXPECT_EQ(toml_of(nlohmann::ordered_json::parse(R"({"a b":"\u0001\n"})")),
            R"({ "a b" = "\u0001\n" })");
}

TEST(Splice, WhatCannotBeDoneIsSaid) {
  EXPECT_THAT(message(kScene, R"({"remove":["intruder",2]})"),
              HasSubstr("a.toml: intruder[2] is not there"));
  EXPECT_THAT(message(kScene, R"({"set":["intruder",5,"id"],"to":"x"})"),
              HasSubstr("intruder[5].id is not there"));
  EXPECT_THAT(message(kScene, R"({"set":["lens","vertical_fov_deg","x"],"to":1})"),
              HasSubstr("lies in a value"));
  EXPECT_THAT(message(kScene, R"({"set":["intruder"],"to":[1]})"), HasSubstr("table of its own"));
  EXPECT_THAT(message(kScene, R"({"insert":["lens"],"table":{"a":1}})"),
              HasSubstr("is no array of tables"));
  EXPECT_THAT(message(kScene, R"({"insert":["intruder"],"at":3,"table":{"a":1}})"),
              HasSubstr("has 2 elements; expected a place from 0 to 2"));
  for (const char* wrong : {R"({})",
                            R"([])",
                            R"({"set":["a"]})",
                            R"({"set":[],"to":1})",
                            R"({"set":[0],"to":1})",
                            R"({"set":["a",-1],"to":1})",
                            R"({"set":["a"],"to":null})",
                            R"({"set":"a","to":1})",
                            R"({"remove":["a"],"to":1})",
                            R"({"insert":["a"],"table":1})",
                            R"({"remove":[{}]})"})
    EXPECT_NE(message(kScene, wrong), "no error") << wrong;
}

// Each value of a hard text is set and removed, and all others stay as they were.
void visit(const nlohmann::json& values,
           nlohmann::json& path,
           const std::function<void(const nlohmann::json&)>& see) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto it = std::next(values.begin(), static_cast<std::ptrdiff_t>(i));
    path.push_back(values.is_object() ? nlohmann::json(it.key()) : nlohmann::json(i));
    see(path);
    if (it->is_structured()) visit(*it, path, see);
    path.erase(path.end() - 1);
  }
}

TEST(Splice, NoChangeDamagesAHardText) {
  const std::string hard =
      "# c\nname = \"\xC3\xA4\xC3\xB6\" # x\r\nlens.model = 'p' # y\nlens . fov = 60.0 \n[a.b]\nx "
      "= [ 1, "
      "# c, d\n  2,\n]  # after\ny = { q = 1, r.s = [1,2], t = {} }\n[[intruder]] "
      "# head\nid='a'\n[[intruder.seen]]\ntime_s = 0x10\npixel = [1.0e3,2]\n[[intruder.seen]]\n"
      "[intruder.encounter]\nz=1979-05-27T07:32:00Z\n  [[intruder]]\n  \"quo ted\" = "
      "\"\"\"multi\n[[x]]\"\"\"\nseen = [ {a=1} , # one\n {a=2}\n]\n[late]\nv=-1";
  nlohmann::json path = nlohmann::json::array();
  int made = 0, refused = 0;
  visit(tree_of(hard, "").values, path, [&](const nlohmann::json& at) {
    for (const nlohmann::json& change : {nlohmann::json{{"set", at}, {"to", 12.5}},
                                         nlohmann::json{{"set", at}, {"to", {1, 2}}},
                                         nlohmann::json{{"remove", at}}}) {
      try {
        with(hard, change.dump());  // throws where another value changed
        ++made;
      } catch (const Error& error) {
        EXPECT_THAT(error.what(), testing::AnyOf(HasSubstr("in place"), HasSubstr("its own")));
        ++refused;
      }
    }
  });
  EXPECT_GT(made, 70);
  EXPECT_EQ(refused, 26);  // tables that would become values, and a dotted table in an inline one
}

}  // namespace
}  // namespace airtruth::document
