// SPDX-License-Identifier: Apache-2.0
#include "foundation/json/json_object.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "foundation/json/parse_json.h"
#include "support/error_of.h"

namespace airtruth {
namespace {

using testing::ElementsAre;

JsonDocument json(std::string_view text) { return {text, {"a.json"}}; }

template <typename Read>
std::string error_of(std::string_view text, const Read& read) {
  return test_support::error_of([&] { read(json(text)); });
}

TEST(JsonObject, ReadsEachKindOfValue) {
  const JsonDocument all = json(
      R"({"t": "x", "b": true, "zero": 0, "n": -1.5, "w": 640.0, "ns": 1700000000000000001,
          "list": [1, 2.5], "box": [1, 2, 3, 4], "m": [[1, 2], [3, 4]], "s": ["p", "q"],
          "nothing": null, "o": {"k": 7}, "os": [{"k": 8}]})");
  EXPECT_EQ(all.text("t"), "x");
  EXPECT_TRUE(all.truth("b"));
  EXPECT_FALSE(all.truth("zero"));
  EXPECT_EQ(all.number("n"), -1.5);
  EXPECT_EQ(all.whole("w", 1, 65536), 640);
  EXPECT_EQ(all.maybe_integer("ns"), 1700000000000000001);
  EXPECT_EQ(all.maybe_integer("n"), -2);
  EXPECT_THAT(all.numbers("list"), ElementsAre(1, 2.5));
  EXPECT_THAT(all.wholes("box", 4, 0, 9), ElementsAre(1, 2, 3, 4));
  EXPECT_THAT(all.matrix("m", 2, 2), ElementsAre(1, 2, 3, 4));
  EXPECT_THAT(all.texts("s"), ElementsAre("p", "q"));
  EXPECT_FALSE(all.has("nothing"));
  EXPECT_EQ(all.maybe_number("nothing"), std::nullopt);
  EXPECT_EQ(all.object("o").count("k"), 7);
  EXPECT_EQ(all.objects("os").at(0).place(), "os[0]");
  EXPECT_EQ(all.keys().front(), "t");
}

TEST(JsonObject, ErrorsNameFileKeyValueAndWhatWasExpected) {
  EXPECT_EQ(error_of("[]", [](const auto&) {}), "a.json: is a list; expected an object");
  EXPECT_EQ(error_of("{}", [](const auto& j) { j.text("k"); }),
            "a.json: has no k; expected a string");
  EXPECT_EQ(error_of(R"({"images": [{}, {}]})",
                     [](const auto& j) { j.objects("images")[1].number("width"); }),
            "a.json: images[1] has no width; expected a number");
  EXPECT_EQ(error_of(R"({"images": [{"width": "x"}]})",
                     [](const auto& j) { j.objects("images")[0].whole("width", 1, 9); }),
            "a.json: images[0].width is \"x\"; expected a whole number from 1 to 9");
  // 2^64 - 1 would be -1 in a signed 64-bit integer.
  EXPECT_EQ(error_of(R"({"n": 18446744073709551615})", [](const auto& j) { j.count("n"); }),
            "a.json: n is 18446744073709551615; expected a whole number from 0 to "
            "9007199254740992");
  EXPECT_EQ(
      error_of(R"({"o": {"v": [1, null]}})", [](const auto& j) { j.object("o").numbers("v"); }),
      "a.json: o.v[1] is null; expected a number");
  EXPECT_EQ(error_of(R"({"v": [1]})", [](const auto& j) { j.numbers("v", 2); }),
            "a.json: v is a list; expected a list of 2 numbers");
  EXPECT_EQ(error_of(R"({"m": [[1, 2], [3]]})", [](const auto& j) { j.matrix("m", 2, 2); }),
            "a.json: m is a list; expected 2 lists of 2 numbers");
  EXPECT_EQ(error_of("{\n\"a\": }", [](const auto&) {}), "a.json:2: is not JSON");
  EXPECT_EQ(error_of(R"({"a": 1e999})", [](const auto&) {}),
            "a.json: holds a number that is too large for 64 bits");
}

TEST(JsonObject, ErrorsOfALineNameTheLine) {
  try {
    JsonDocument("{\"a\": 1}", {"t.jsonl", 7}).text("a");
    FAIL();
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(), "t.jsonl:7: a is 1; expected a string");
  }
}

TEST(JsonObject, ErrorsNameTheLineOfTheKeyWhereTheTextIsGiven) {
  const std::string text = "{\n\"a\": {\n\"b\": [1,\n \"x\"]}}";
  try {
    json(text).with_lines_of(text).object("a").numbers("b");
    FAIL();
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(), "a.json:3: a.b[1] is \"x\"; expected a number");
  }
}

// A list with a million levels is refused without recursion to that depth.
TEST(JsonObject, DeepValuesAreRefused) {
  constexpr std::size_t kDepth = 1'000'000;
  const std::string text = "{\"a\": " + std::string(kDepth, '[') + std::string(kDepth, ']') + "}";
  EXPECT_EQ(error_of(text, [](const auto& j) { j.number("a"); }),
            "a.json: is nested deeper than 64 levels");
  EXPECT_TRUE(parse_json(text).is_discarded());
}

TEST(ParseJson, LevelsAreCountedOutsideOfTexts) {
  const auto nested = [](int levels) {
    const auto count = static_cast<std::size_t>(levels);
    return std::string(count, '[') + std::string(count, ']');
  };
  EXPECT_TRUE(parse_json(nested(kMostNesting)).is_array());
  EXPECT_TRUE(parse_json(nested(kMostNesting + 1)).is_discarded());
  EXPECT_TRUE(parse_json("[" + nested(40) + "," + nested(40) + "]").is_array());
  EXPECT_EQ(parse_json("{\"a\\\"" + std::string(100, '[') + "\": 1}").size(), 1u);
  EXPECT_TRUE(parse_json("{\"a\": ").is_discarded());
}

TEST(JsonObject, AnUnknownKeyIsNamedAtItsLineWithTheNearest) {
  const std::string text = "{\n\"width\": 1,\n\"hieght\": 2}";
  const JsonDocument document(text, {"a.json"});
  const auto fault = [&](const std::vector<std::string>& known) -> std::string {
    return test_support::error_of([&] { document.with_lines_of(text).expect_keys_among(known); });
  };
  EXPECT_EQ(fault({"width", "hieght"}), "no error");
  EXPECT_EQ(fault({"width", "height"}),
            "a.json:3: unknown key \"hieght\"; did you mean \"height\"?");
  EXPECT_EQ(fault({"width", "x"}), "a.json:3: unknown key \"hieght\"; expected one of width, x");
}

}  // namespace
}  // namespace airtruth
