// SPDX-License-Identifier: Apache-2.0
#include "foundation/picture_series/series.h"

#include <gmock/gmock.h>

namespace airtruth::picture_series {
namespace {

using ::testing::ElementsAre;
using ::testing::UnorderedElementsAre;

std::vector<std::vector<std::string>> series(const std::vector<std::string>& names,
                                             Stray stray = Stray::kOfOneSeries) {
  std::vector<std::vector<std::string>> all;
  for (const Series& one : series_of(names, stray)) {
    all.emplace_back();
    for (const std::size_t i : one) all.back().push_back(names[i]);
  }
  return all;
}

TEST(Series, NumbersCompareWhateverTheirLength) {
  EXPECT_TRUE(is_numbered_before("f9.png", "f10.png"));
  EXPECT_TRUE(is_numbered_before("f010.png", "f11.png"));
  EXPECT_FALSE(is_numbered_before("f10.png", "f9.png"));
  EXPECT_TRUE(is_numbered_before("1566556046185850369a.png", "1566556046285850369a.png"));
}

TEST(Series, NamesThatDifferInNumbersAloneAreOne) {
  EXPECT_THAT(series({"10.jpg", "9.jpg", "1.JPG"}),
              ElementsAre(ElementsAre("1.JPG", "9.jpg", "10.jpg")));
  EXPECT_THAT(series({"frame10_left.png", "frame9_left.png"}),
              ElementsAre(ElementsAre("frame9_left.png", "frame10_left.png")));
  // VisDrone: the last number falls.
  EXPECT_THAT(
      series({"0000011_00050_d_0000116.jpg", "0000011_00000_d_0000117.jpg"}),
      ElementsAre(ElementsAre("0000011_00000_d_0000117.jpg", "0000011_00050_d_0000116.jpg")));
  // Times of the day over a full minute.
  EXPECT_THAT(
      series({"10-33-00.jpg", "10-32-58.jpg", "10-33-01.jpg", "10-32-59.jpg"}),
      ElementsAre(ElementsAre("10-32-58.jpg", "10-32-59.jpg", "10-33-00.jpg", "10-33-01.jpg")));
  EXPECT_THAT(series({"a_0002_jpg.rf.0c1d.jpg", "a_0001_jpg.rf.ffee.jpg"}),
              ElementsAre(ElementsAre("a_0001_jpg.rf.ffee.jpg", "a_0002_jpg.rf.0c1d.jpg")));
}

TEST(Series, EachWordAndEachBeginningIsOne) {
  EXPECT_THAT(series({"b_2.jpg", "a_1.jpg", "b_1.jpg", "a_2.jpg"}),
              ElementsAre(ElementsAre("a_1.jpg", "a_2.jpg"), ElementsAre("b_1.jpg", "b_2.jpg")));
  EXPECT_THAT(series({"pass-2_000000.jpg", "pass-1_000000.jpg", "pass-1_000001.jpg"}),
              ElementsAre(ElementsAre("pass-1_000000.jpg", "pass-1_000001.jpg"),
                          ElementsAre("pass-2_000000.jpg")));
}

TEST(Series, AStrayIsOfTheOneSeriesOrApart) {
  const std::vector<std::string> names = {"f1.jpg", "cover.jpg", "f2.jpg"};
  EXPECT_THAT(series(names), ElementsAre(ElementsAre("cover.jpg", "f1.jpg", "f2.jpg")));
  EXPECT_THAT(series(names, Stray::kApart),
              UnorderedElementsAre(ElementsAre("cover.jpg"), ElementsAre("f1.jpg", "f2.jpg")));
  const std::vector<std::string> uuids = {"a5771bce-93e2.jpg", "6c8349cc-7260.jpg"};
  for (const Stray stray : {Stray::kOfOneSeries, Stray::kApart})
    EXPECT_THAT(series(uuids, stray),
                ElementsAre(ElementsAre("6c8349cc-7260.jpg", "a5771bce-93e2.jpg")));
}

TEST(Series, HaveACommonName) {
  const auto common = [](std::vector<std::string> names) { return common_name(names); };
  EXPECT_EQ(common({"pass-1_000000.jpg", "pass-1_000012.jpg"}), "pass-1");
  EXPECT_EQ(common({"pass-1_000000.jpg"}), "pass-1");
  EXPECT_EQ(common({"000000.jpg", "000001.jpg"}), "");
  EXPECT_EQ(common({"a_0002_jpg.rf.0c1d.jpg", "a_0001_jpg.rf.0c1e.jpg"}), "a");
}

}  // namespace
}  // namespace airtruth::picture_series
