// SPDX-License-Identifier: Apache-2.0
#include "dataset/sequences/layout.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "support/error_of.h"
#include "support/temporary_folder.h"

namespace airtruth::sequences {
namespace {

using test_support::error_of;
using testing::ElementsAre;
using testing::HasSubstr;

class LayoutTest : public testing::Test {
 protected:
  LayoutTest() { fs::create_directories(root_ / "sequences"); }

  // A folder that counts as a finished sequence.
  void add_sequence(const fs::path& place) const {
    fs::create_directories(root_ / "sequences" / place);
    write_file(root_ / "sequences" / place / "sequence.json", "{}");
  }

  test_support::TemporaryFolder temporary_;
  fs::path root_ = temporary_.path();
};

TEST(Layout, ASmallSetLiesInOneFolder) {
  EXPECT_FALSE(layout_for(4000, 4000).is_divided());
  EXPECT_EQ(layout_for(4000, 4000).folder_of(3999), "");
}

TEST(Layout, ALargeSetLiesInNumberedFoldersOfEquallyMany) {
  const Layout layout = layout_for(10'000, 4000);
  EXPECT_EQ(layout.folder_of(0), "0001");
  EXPECT_EQ(layout.folder_of(3999), "0001");
  EXPECT_EQ(layout.folder_of(4000), "0002");
  EXPECT_EQ(layout.folder_of(9999), "0003");
  // The number grows beyond four digits.
  EXPECT_EQ(layout_for(1'000'000'000, 4000).folder_of(999'999'999), "250000");
}

TEST_F(LayoutTest, IsReadAsItWasWritten) {
  const fs::path sequences = root_ / "sequences";
  EXPECT_FALSE(read_layout(sequences).is_divided());
  write_layout(sequences, layout_for(11, 10));
  EXPECT_EQ(read_layout(sequences).sequences_in_a_folder, 10);
  write_layout(sequences, layout_for(10, 10));
  EXPECT_FALSE(fs::exists(sequences / "layout.json"));
}

TEST_F(LayoutTest, ABrokenFileIsAnErrorThatNamesIt) {
  const fs::path file = root_ / "sequences" / "layout.json";
  const auto error = [&](const std::string& text) {
    write_file(file, text);
    return error_of([&] { read_layout(root_ / "sequences"); });
  };
  for (const char* text : {"",
                           "{}",
                           R"({"format": "airtruth layout 2", "sequences_in_a_folder": 5})",
                           R"({"format": "airtruth layout 1"})",
                           R"({"format": "airtruth layout 1", "sequences_in_a_folder": 0})",
                           R"({"format": "airtruth layout 1", "sequences_in_a_folder": "5"})"})
    EXPECT_THAT(error(text), HasSubstr("layout.json")) << text;
}

TEST_F(LayoutTest, SequencesOfAllNumberedFoldersAreFoundByName) {
  write_layout(root_ / "sequences", layout_for(3, 2));
  add_sequence("0001/b");
  add_sequence("0001/c");
  add_sequence("0002/a");
  add_sequence("0002/.d.part");                                // under way
  fs::create_directories(root_ / "sequences" / "0002" / "e");  // no record
  add_sequence("aside/f");                                     // no numbered folder
  const SequenceFolders found = sequence_folders(root_);
  EXPECT_THAT(found.names, ElementsAre("a", "b", "c"));
  EXPECT_EQ(found.folder("a"), root_ / "sequences" / "0002" / "a");
  EXPECT_EQ(found.folder("b"), root_ / "sequences" / "0001" / "b");
  EXPECT_THAT(sequence_folders(root_ / "sequences").names, ElementsAre("a", "b", "c"));
  EXPECT_THAT(sequence_folders(root_ / "sequences" / "0001").names, ElementsAre("b", "c"));
}

TEST_F(LayoutTest, WithoutALayoutFoldersWithDigitsAreNoParts) {
  add_sequence("0001/b");
  add_sequence("2");
  EXPECT_THAT(sequence_folders(root_).names, ElementsAre("2"));
}

TEST_F(LayoutTest, ANameInTwoNumberedFoldersIsAnError) {
  write_layout(root_ / "sequences", layout_for(3, 2));
  add_sequence("0001/b");
  add_sequence("0002/b");
  EXPECT_THAT(error_of([&] { sequence_folders(root_); }), HasSubstr("'b' in both 0001 and 0002"));
}

}  // namespace
}  // namespace airtruth::sequences
