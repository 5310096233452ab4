// SPDX-License-Identifier: Apache-2.0
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "foundation/base/error.h"
#include "studio/messages/request.h"
#include "support/error_of.h"

namespace airtruth::messages {
namespace {

using testing::HasSubstr;

std::string fault_of(const std::string& text) {
  return test_support::error_of([&] { request_from(text); });
}

TEST(RequestText, AFrameIsAskedForWithWhatItShows) {
  const Request request =
      request_from(R"({"id":7,"do":"frame","frame":12,"aircraft":false,"crop":null,"scale":0.5})");
  EXPECT_EQ(request.id, 7);
  EXPECT_EQ(request.act, Act::kFrame);
  EXPECT_EQ(request.frame, 12);
  EXPECT_FALSE(request.aircraft);
  EXPECT_FALSE(request.crops_to_change);
  EXPECT_EQ(request.scale, 0.5);
  EXPECT_TRUE(request_from(R"({"id":1,"do":"frame","frame":1,"crop":"change"})").crops_to_change);
}

TEST(RequestText, AnEditHasItsChanges) {
  const Request request = request_from(
      R"({"id":1,"do":"edit","merge":"drag-1","changes":[{"set":["seed"],"to":3},
          {"insert":["intruder"],"at":null,"table":{"id":"a"}},{"remove":["lens"]}]})");
  EXPECT_EQ(request.merge, "drag-1");
  ASSERT_EQ(request.changes.size(), 3u);
  EXPECT_EQ(document::words_of(request.changes[1].path), "intruder");
  EXPECT_EQ(request_from(R"({"id":1,"do":"edit","merge":null,"changes":[]})").merge, "");
  EXPECT_EQ(request_from(R"({"id":1,"do":"keep"})").act, Act::kKeep);
  EXPECT_EQ(request_from(R"({"id":1,"do":"aircraft","search":"a320"})").search, "a320");
}

TEST(RequestText, WhatIsNoMessageIsSaid) {
  EXPECT_THAT(fault_of("["), HasSubstr("no JSON object"));
  EXPECT_THAT(fault_of("[]"), HasSubstr("no JSON object"));
  EXPECT_THAT(fault_of(R"({"do":"open"})"), HasSubstr("id"));
  EXPECT_THAT(fault_of(R"({"id":1,"do":"opne"})"), HasSubstr("open"));
  EXPECT_THAT(fault_of(R"({"id":1,"do":"open","path":"/etc/passwd"})"), HasSubstr("path"));
  EXPECT_THAT(fault_of(R"({"id":1,"do":"frame"})"), HasSubstr("frame"));
  EXPECT_THAT(fault_of(R"({"id":1,"do":"frame","frame":-1})"), HasSubstr("whole number from 0"));
  EXPECT_THAT(fault_of(R"({"id":1,"do":"frame","frame":1,"scale":0})"), HasSubstr("scale"));
  EXPECT_THAT(fault_of(R"({"id":1,"do":"frame","frame":1,"crop":[1,2,3,4]})"), HasSubstr("crop"));
  EXPECT_THAT(fault_of(R"({"id":1,"do":"frame","frame":1,"crop":"all"})"), HasSubstr("crop"));
  EXPECT_THAT(fault_of(R"({"id":1,"do":"edit"})"), HasSubstr("changes"));
  EXPECT_THAT(fault_of(R"({"id":1,"do":"edit","changes":[{"set":["a"],"to":null}]})"),
              HasSubstr("changes[0].to"));
  const auto near_miss = [](const std::string& numbers) {
    return fault_of(R"({"id":1,"do":"near_miss","intruder":0,"frame":1,"right":true,)" + numbers);
  };
  EXPECT_THAT(near_miss(R"("miss_m":-1,"speed_mps":50})"), HasSubstr("miss_m"));
  EXPECT_THAT(near_miss(R"("miss_m":80,"speed_mps":0})"), HasSubstr("speed_mps"));
  EXPECT_THAT(near_miss(R"("miss_m":80})"), HasSubstr("speed_mps"));
  EXPECT_THAT(near_miss(R"("miss_m":80,"speed_mps":50,"above_m":1e6})"), HasSubstr("above_m"));
  EXPECT_THAT(fault_of(R"({"id":1,"do":"aircraft","search":")" + std::string(500, 'a') + "\"}"),
              HasSubstr("at most 200"));
}

TEST(RequestText, LongAndDeepTextsAreRefusedBeforeTheyAreRead) {
  EXPECT_THAT(fault_of(std::string(kMostRequestBytes + 1, ' ')), HasSubstr("16 MiB"));
  const std::string deep = R"({"id":1,"do":"edit","changes":)" + std::string(60'000, '[');
  EXPECT_THAT(fault_of(deep), HasSubstr("nested too deep"));
  EXPECT_FALSE(id_of(deep));
  EXPECT_EQ(id_of(R"({"id":5,"do":7})"), 5);
  EXPECT_FALSE(id_of(R"({"id":"5"})"));
  // Brackets within strings are none.
  EXPECT_EQ(
      request_from(R"({"id":1,"do":"aircraft","search":"\"[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[["})")
          .search[0],
      '"');
}

TEST(TargetText, ValuesLoseTheirEscapes) {
  const auto target = target_from("/aircraft.jpg?token=ab&name=738%2F738-Ryan+air&x=&y");
  ASSERT_TRUE(target);
  EXPECT_EQ(target->path, "/aircraft.jpg");
  EXPECT_EQ(target->value("name"), "738/738-Ryan air");
  EXPECT_EQ(target->value("x"), "");
  EXPECT_EQ(target->value("z"), "");
  EXPECT_EQ(target_from("/thumb?frame=12")->whole("frame", 0, 20), 12);
  for (const char* wrong : {"-1", "21", "1.5", "", "1x", "99999999999999999999"})
    EXPECT_FALSE(target_from(std::string("/thumb?frame=") + wrong)->whole("frame", 0, 20)) << wrong;
}

TEST(TargetText, OthersAreNone) {
  for (const char* wrong : {"", "*", "http://a/", "/?a=%", "/?a=%4", "/?a=%zz", "/?%g1=1"})
    EXPECT_FALSE(target_from(wrong)) << wrong;
  EXPECT_FALSE(target_from("/" + std::string(5000, 'a')));
}

TEST(RangeText, AsBrowsersAskForIt) {
  const auto range = [](const char* text) { return range_from(text, 1000, 300); };
  EXPECT_EQ(range("bytes=0-")->first, 0u);
  EXPECT_EQ(range("bytes=0-")->last, 299u);
  EXPECT_EQ(range("bytes=990-")->last, 999u);
  EXPECT_EQ(range("bytes=10-20")->last, 20u);
  EXPECT_EQ(range("bytes=10-5000")->last, 309u);
  EXPECT_EQ(range("bytes=-100")->first, 900u);
  EXPECT_EQ(range("bytes=-5000")->first, 0u);
  for (const char* other : {"",
                            "bytes",
                            "bytes=",
                            "bytes=-",
                            "bytes=1000-",
                            "bytes=5-4",
                            "bytes=a-b",
                            "bytes=0-1,5-6",
                            "lines=0-1",
                            "bytes=--1"})
    EXPECT_FALSE(range(other)) << other;
  EXPECT_FALSE(range_from("bytes=0-", 0, 300));
}

}  // namespace
}  // namespace airtruth::messages
