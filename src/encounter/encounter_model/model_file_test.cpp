// SPDX-License-Identifier: Apache-2.0
#include "encounter/encounter_model/model_file.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "foundation/base/error.h"
#include "support/error_of.h"
#include "support/shared_folder.h"
#include "support/small_encounter_model.h"

namespace airtruth::encounter_model {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::StartsWith;

// The small model with one piece of text replaced.
std::string changed(const std::string& from, const std::string& to) {
  std::string text = test_support::kSmallModel;
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

std::string fault_of(const std::string& text) {
  return test_support::error_of([&] { parse_model(text, "model.txt"); });
}

TEST(ModelFile, TablesFollowTheGraph) {
  const BayesModel model = parse_model(test_support::kSmallModel, "model.txt");
  EXPECT_THAT(model.labels, ElementsAre("G", "L", "v", "\\dot v", "\\dot h", "\\dot \\psi"));
  EXPECT_THAT(model.initial[1].parents, ElementsAre(0u));
  EXPECT_THAT(model.initial[1].sums, ElementsAre(80, 100, 1, 4));
  EXPECT_THAT(model.initial[5].sums, ElementsAre(10, 90, 100, 25, 75, 100, 5, 10, 100));
  EXPECT_THAT(model.transition[1].parents, ElementsAre(4u, 8u));
  EXPECT_EQ(model.transition[1].columns(), 9u);
  EXPECT_THAT(model.transition[2].parents, ElementsAre(1u, 5u));
  EXPECT_EQ(model.transition[2].total(5), 0);
  // The new vertical rate comes after the new turn rate, its parent.
  EXPECT_THAT(model.transition_order, ElementsAre(0u, 2u, 1u));
  ASSERT_EQ(model.dynamic.size(), 3u);
  EXPECT_EQ(model.dynamic[2].now, 5u);
  EXPECT_EQ(model.dynamic[2].next, 8u);
  EXPECT_EQ(model.dynamic[2].resample_rate, 0.3);
  EXPECT_TRUE(model.edges[0].empty());
  EXPECT_THAT(model.edges[1], ElementsAre(500, 1500, 5000));
  EXPECT_FALSE(model.places.airspace.has_value());
  EXPECT_EQ(model.places.turn_rate_dps, 5u);
}

TEST(ModelFile, TheOrderFollowsParentsThatComeLater) {
  // The domain depends on the altitude here, and not the reverse.
  const BayesModel model =
      parse_model(changed("0 1 0 0 0 0\n0 0 1 0 0 0", "0 0 0 0 0 0\n1 0 1 0 0 0")
                      .replace(std::string(test_support::kSmallModel).find("300 100 80 20 1 3"),
                               17,
                               "80 20 1 3 300 100"),
                  "model.txt");
  EXPECT_THAT(model.initial_order, ElementsAre(1u, 2u, 3u, 4u, 5u, 0u));
}

TEST(ModelFile, LineEndsAndBlankLinesDoNotMatter) {
  std::string text;
  for (const char c : std::string(test_support::kSmallModel))
    text += c == '\n' ? "\r\n\r\n" : std::string(1, c);
  EXPECT_EQ(parse_model(text, "model.txt").initial[5].sums,
            parse_model(test_support::kSmallModel, "model.txt").initial[5].sums);
}

TEST(ModelFile, EachFaultNamesTheLineAndWhatWasExpected) {
  EXPECT_THAT(fault_of(""), HasSubstr("has no field '# labels_initial'"));
  EXPECT_THAT(fault_of("1 2 3"), StartsWith("model.txt:1: begins with '1 2 3'"));
  EXPECT_THAT(fault_of(changed("# r_initial", "# r_inital")),
              StartsWith("model.txt:10: unknown field 'r_inital'; did you mean 'r_initial'?"));
  EXPECT_THAT(fault_of(changed("# boundaries", "# r_initial")),
              StartsWith("model.txt:34: field r_initial is twice there; first in line 10"));
  EXPECT_THAT(fault_of(changed("5 5 90\n", "5 5\n")),
              StartsWith("model.txt:13: N_initial holds 26 numbers; expected 27"));
  EXPECT_THAT(fault_of(changed("5 5 90\n", "5 5 90 1\n")),
              StartsWith("model.txt:13: N_initial holds more than 27 numbers; expected 27"));
  EXPECT_THAT(fault_of(changed("300 100", "-300 100")),
              StartsWith("model.txt:13: N_initial holds -300; expected numbers from 0 to"));
  EXPECT_THAT(fault_of(changed("300 100", "nan 100")), HasSubstr("holds 'nan'; expected finite"));
  EXPECT_THAT(fault_of(changed("300 100", "3e999 100")), HasSubstr("holds '3e999'"));
  EXPECT_THAT(fault_of(changed("300 100", "0 0")),
              StartsWith("model.txt:13: N_initial has no count for 'G'"));
  EXPECT_THAT(fault_of(changed("2 2 3 3 3 3\n", "2 2 3 3 3 0\n")), HasSubstr("from 1 to 1000"));
  EXPECT_THAT(fault_of(changed("2 2 3 3 3 3\n", "2 2 3 3 3 2.5\n")), HasSubstr("whole numbers"));
  EXPECT_THAT(fault_of(changed("0 1 0 0 0 0\n0 0 1", "0 1 0 0 0 0\n1 0 1")),
              StartsWith("model.txt:4: the graph has a cycle"));
  EXPECT_THAT(fault_of(changed("0 1 0 0 0 0", "0 2 0 0 0 0")), HasSubstr("from 0 to 1"));
  EXPECT_THAT(fault_of(changed("60 90 120 150", "60 90 120")),
              StartsWith("model.txt:37: boundaries of 'v' are 3 numbers; expected 4 for 3 bins"));
  EXPECT_THAT(fault_of(changed("60 90 120 150", "60 120 90 150")), HasSubstr("do not increase"));
  EXPECT_THAT(fault_of(changed("500 1500 5000", "*")), HasSubstr("of 'L' are *"));
  EXPECT_THAT(fault_of(changed("0 0 0.05", "0 0 1.05")), HasSubstr("expected numbers from 0 to 1"));
  EXPECT_THAT(fault_of(changed("\"\\dot h(t+1)\"", "\"\\dot k(t+1)\"")),
              HasSubstr("'\\dot h(t)' has no partner; expected a label '\\dot h(t+1)'"));
  EXPECT_THAT(fault_of(changed("2 2 3 3 3 3 3 3 3", "2 2 4 3 3 3 3 3 3")),
              HasSubstr("r_transition gives 'v' 4 bins; expected 3 as in r_initial"));
  EXPECT_THAT(fault_of(changed("\"L\", \"v\", \"\\dot v\",", "\"L\", \"v\", \"L\",")),
              HasSubstr("holds 'L' twice"));
}

TEST(ModelFile, ATableTooLargeIsRefusedBeforeItIsMade) {
  const std::string text = changed("2 2 3 3 3 3\n", "1000 1000 1000 3 1000 1000\n");
  EXPECT_THAT(fault_of(text), HasSubstr("holds 27 numbers; expected 3002003"));
  // Every variable a parent of every later one.
  const std::string full =
      changed("0 1 0 0 0 0\n0 0 1 0 0 0\n0 0 0 0 0 0\n0 0 0 0 0 0\n0 0 0 0 0 1",
              "0 1 1 1 1 1\n0 0 1 1 1 1\n0 0 0 1 1 1\n0 0 0 0 1 1\n0 0 0 0 0 1");
  std::string many = full;
  many.replace(many.find("2 2 3 3 3 3\n"), 12, "99 99 99 99 99 99\n");
  EXPECT_THAT(fault_of(many), HasSubstr("needs more than 20000000 counts"));
}

TEST(ModelFile, EveryCutOffFileIsAnError) {
  const std::string text = test_support::kSmallModel;
  // A cut within the last number, or the blanks after it, leaves a whole file.
  for (std::size_t size = 0; size + 4 < text.size(); ++size)
    EXPECT_THROW(parse_model(text.substr(0, size), "model.txt"), Error) << size;
}

TEST(ModelFile, PublishedModelsAreRead) {
  const char* shared = test_support::shared_folder();
  if (shared == nullptr) GTEST_SKIP() << "AIRTRUTH_SHARED is unset";
  const fs::path folder = fs::path(shared) / "encounters" / "models";
  struct Expected {
    const char* name;
    std::size_t initial, dynamic;
    // Sum of the counts of the first variable, added up by hand from the file.
    double total;
  };
  for (const Expected& expected : {Expected{"uncor_1200code_v2p1.txt", 7, 3, 486848502},
                                   Expected{"balloon_v1.txt", 2, 1, 36275},
                                   Expected{"blimp_v1.txt", 5, 3, 21027},
                                   Expected{"uncor_1200only_fwme_v1p2.txt", 7, 3, 0},
                                   Expected{"uncor_1200only_fwse_v1p2.txt", 7, 3, 0},
                                   Expected{"uncor_1200only_rotorcraft_v1p2.txt", 7, 3, 0}}) {
    const BayesModel model = read_model(folder / expected.name);
    EXPECT_EQ(model.labels.size(), expected.initial) << expected.name;
    EXPECT_EQ(model.dynamic.size(), expected.dynamic) << expected.name;
    if (expected.total > 0) {
      EXPECT_EQ(model.initial[0].total(0), expected.total) << expected.name;
    }
    EXPECT_EQ(model.places.speed_kt.has_value(), expected.dynamic == 3) << expected.name;
  }
}

}  // namespace
}  // namespace airtruth::encounter_model
