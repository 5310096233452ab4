// SPDX-License-Identifier: Apache-2.0
#include "studio/document/document.h"

#include <chrono>
#include <csignal>
#include <fstream>
#include <iterator>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "studio/document/tree.h"
#include "support/error_of.h"
#include "support/temporary_folder.h"

namespace airtruth::document {
namespace {

using testing::HasSubstr;
const std::string kText =
    "[background]\nvideo = \"clip.mp4\"  # mine\n[lens]\nvertical_fov_deg = 60\n";

class OfAFile : public testing::Test {
 protected:
  OfAFile() { write(kText); }
  fs::path file() const { return folder_.path() / "scene.toml"; }
  fs::path journal() const { return folder_.path() / ".scene.toml.studio-journal"; }
  void write(const std::string& text) {
    write_file(file(), text);
    // A clock of whole seconds must not hide the change.
    fs::last_write_time(file(), fs::last_write_time(file()) + std::chrono::seconds(++writes_));
  }
  Document open() {
    return {file(), std::nullopt, [this](const std::string& line) { warnings_.push_back(line); }};
  }
  static std::vector<Change> fov(double value) {
    return {{Change::Kind::kSet, {"lens", "vertical_fov_deg"}, {}, value}};
  }
  static std::string with_fov(const std::string& value) {
    return kText.substr(0, kText.find("60")) + value + "\n";
  }

  test_support::TemporaryFolder folder_;
  std::vector<std::string> warnings_;
  int writes_ = 0;
};

TEST_F(OfAFile, StepsAreTakenBackToTheBeginningAndRepeated) {
  Document document = open();
  document.edit(fov(61), "");
  for (int i = 0; i < 20; ++i) document.edit(fov(62 + i), "drag-1");
  document.edit(fov(90), "drag-2");
  EXPECT_EQ(document.state()["undo"], 3);
  EXPECT_EQ(document.text(), with_fov("90"));
  document.undo();
  EXPECT_EQ(document.text(), with_fov("81"));
  document.undo();
  EXPECT_EQ(document.text(), with_fov("61"));
  document.undo();
  EXPECT_EQ(document.text(), kText);
  EXPECT_THROW(document.undo(), Error);
  document.redo();
  document.redo();
  EXPECT_EQ(document.text(), with_fov("81"));
  document.edit(fov(50), "");
  EXPECT_THROW(document.redo(), Error);
}

TEST_F(OfAFile, AllChangesOfAnEditAreMadeOrNone) {
  Document document = open();
  auto changes = fov(70);
  changes.push_back({Change::Kind::kRemove, {"nowhere"}, {}, {}});
  EXPECT_THROW(document.edit(changes, ""), Error);
  EXPECT_EQ(document.text(), kText);
  EXPECT_EQ(document.state()["undo"], 0);
}

TEST_F(OfAFile, ChangesAreMadeUponTheirTextOrNotAtAll) {
  Document document = open();
  const std::string before = sha256_of(kText);
  EXPECT_EQ(document.state()["sha256"], before);
  EXPECT_TRUE(document.edit(fov(61), "", before));
  EXPECT_TRUE(document.edit(fov(61), "", before)) << "sent again, since its answer was lost";
  EXPECT_EQ(document.state()["undo"], 1);
  EXPECT_FALSE(document.edit(fov(62), "", before));
  EXPECT_EQ(document.text(), with_fov("61"));
  document.undo();
  EXPECT_TRUE(document.edit(fov(61), "", before));
  EXPECT_EQ(document.text(), with_fov("61"));
  EXPECT_TRUE(document.edit(fov(62), "", sha256_of(with_fov("61"))));
  EXPECT_FALSE(document.edit(fov(61), "", before));
  EXPECT_EQ(document.text(), with_fov("62"));
}

TEST_F(OfAFile, TablesAreFoundWhereTheSceneHasThem) {
  write(
      "intruder = [{ aircraft = \"a\", path_file = \"p\" }, { id = \"ä\", aircraft = "
      "\"b\", path_file = \"p\" }, { aircraft = \"c\", path_file = \"p\" }]\n" +
      kText + "[[distractor]]\nkind = \"bird\"\nposition_ned_m = [9, 0, 0]\n");
  Document document = open();
  ASSERT_TRUE(document.scene()) << document.problem();
  const auto& all = document.scene()->intruders;
  ASSERT_EQ(all.size(), 4u);
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_EQ(document.tables().at(begin_of(all[i].where)),
              (nlohmann::ordered_json{"intruder", i}));
  EXPECT_EQ(document.tables().at(begin_of(all[3].where)),
            (nlohmann::ordered_json{"distractor", 0}));
}

TEST_F(OfAFile, ATextThatIsNoSceneIsKeptWithItsProblem) {
  Document document = open();
  document.edit({{Change::Kind::kSet, {"lens", "vertical_fov"}, {}, 60}}, "");
  EXPECT_THAT(document.problem(), HasSubstr("vertical_fov_deg"));
  EXPECT_FALSE(document.scene());
  EXPECT_EQ(document.state()["scene"]["lens"]["vertical_fov"], 60);
  document.undo();
  EXPECT_EQ(document.problem(), "");
  EXPECT_TRUE(document.scene());
}

TEST_F(OfAFile, ACrashLosesNothing) {
  {
    Document document = open();
    document.edit(fov(61), "");
    for (int i = 0; i < 20; ++i) document.edit(fov(62 + i), "drag");
    document.edit(fov(99), "");
    document.undo();
  }
  EXPECT_EQ(read_file(file()), kText);
  std::ofstream(journal(), std::ios::app) << "{\"at\":1,\"remov";  // a line that was not finished
  Document document = open();
  EXPECT_THAT(warnings_, testing::ElementsAre(HasSubstr("2 steps that were not saved")));
  EXPECT_EQ(document.text(), with_fov("81"));
  EXPECT_FALSE(document.state()["saved"]);
  document.redo();
  EXPECT_EQ(document.text(), with_fov("99"));
  document.undo();
  document.undo();
  document.undo();
  EXPECT_EQ(document.text(), kText);
}

// A limit of the size of files stands for a full disk: a part of the second step still fits.
TEST_F(OfAFile, AStepThatTheDiskHadNoRoomForIsWrittenWithTheNext) {
  {
    Document document = open();
    document.edit(fov(61), "");
    rlimit unlimited{};
    ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &unlimited), 0);
    const auto handler = std::signal(SIGXFSZ, SIG_IGN);
    const rlimit full{fs::file_size(journal()) + 10, unlimited.rlim_max};
    ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &full), 0);
    document.edit(fov(62), "");
    document.edit(fov(63), "");
    ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &unlimited), 0);
    std::signal(SIGXFSZ, handler);
    document.edit(fov(64), "");
    document.edit(fov(65), "");
  }
  Document document = open();
  EXPECT_THAT(warnings_,
              testing::ElementsAre(HasSubstr("cannot be written"),
                                   HasSubstr("5 steps that were not saved")));
  EXPECT_EQ(document.text(), with_fov("65"));
}

TEST_F(OfAFile, OneStudioAtATimeHasAFile) {
  {
    Document document = open();
    document.edit(fov(61), "");
    fs::create_symlink(file(), folder_.path() / "link.toml");
    for (const fs::path& name : {file(), folder_.path() / "link.toml"})
      EXPECT_THAT(test_support::error_of([&] { Document(name, std::nullopt, {}); }),
                  HasSubstr("scene.toml: is open in another studio"));
    Document(folder_.path() / "other.toml", kText, {});
    document.edit(fov(62), "");
  }
  EXPECT_EQ(open().text(), with_fov("62"));
  const auto files = fs::directory_iterator(folder_.path());
  EXPECT_EQ(std::distance(begin(files), end(files)), 3) << "the scene, its journal and the link";
}

TEST_F(OfAFile, SavedTextNeedsNoJournal) {
  {
    Document document = open();
    document.edit(fov(61), "");
    EXPECT_TRUE(fs::exists(journal()));
    document.save();
    EXPECT_FALSE(fs::exists(journal()));
    EXPECT_EQ(read_file(file()), with_fov("61"));
    document.undo();
    EXPECT_FALSE(document.state()["saved"]);
    EXPECT_TRUE(fs::exists(journal()));
  }
  Document later = open();
  EXPECT_EQ(later.text(), kText);
  EXPECT_FALSE(later.state()["changed_on_disk"]);
  later.redo();
  EXPECT_EQ(later.text(), with_fov("61"));
}

TEST_F(OfAFile, AJournalThatCannotBeWrittenIsSaidUntilItCan) {
  Document document = open();
  EXPECT_TRUE(document.state()["journal_fault"].is_null());
  fs::create_directory(journal());
  document.edit(fov(61), "");
  EXPECT_THAT(document.state()["journal_fault"].get<std::string>(),
              HasSubstr("its journal cannot be written"));
  fs::remove(journal());
  document.edit(fov(62), "");
  EXPECT_TRUE(document.state()["journal_fault"].is_null());
  EXPECT_TRUE(fs::exists(journal()));
}

TEST_F(OfAFile, AnotherEditorsChangeIsTakenWhereAllIsSavedElseSaid) {
  Document document = open();
  EXPECT_FALSE(document.look_at_disk());
  write(with_fov("30"));
  EXPECT_TRUE(document.look_at_disk());
  EXPECT_EQ(document.text(), with_fov("30"));
  document.undo();
  EXPECT_EQ(document.text(), kText);
  write(with_fov("31"));
  EXPECT_TRUE(document.look_at_disk());
  EXPECT_TRUE(document.state()["changed_on_disk"]);
  EXPECT_EQ(document.text(), kText);
  EXPECT_THROW(document.save(), Error);
  EXPECT_EQ(read_file(file()), with_fov("31"));
  document.reload();
  EXPECT_EQ(document.text(), with_fov("31"));
  EXPECT_TRUE(document.state()["saved"]);
}

TEST_F(OfAFile, WhatAnotherProgramChangedIsNotSavedAfterAnUndo) {
  Document document = open();
  document.edit(fov(61), "");
  write(with_fov("30"));
  EXPECT_TRUE(document.look_at_disk());
  document.undo();
  EXPECT_EQ(document.text(), kText);
  EXPECT_FALSE(document.state()["saved"]);
}

TEST_F(OfAFile, AChangeToWhatIsNoTextIsSaidAndNotOverwritten) {
  const std::string latin = kText + "# \xfc\n";
  for (const bool has_steps : {false, true}) {
    write(kText);
    Document document = open();
    if (has_steps) document.edit(fov(61), "");
    write(latin);
    EXPECT_TRUE(document.look_at_disk());
    EXPECT_FALSE(document.look_at_disk());
    EXPECT_TRUE(document.state()["changed_on_disk"]);
    EXPECT_THROW(document.save(), Error);
    EXPECT_THROW(document.reload(), Error);
    EXPECT_EQ(read_file(file()), latin);
    document.keep();
    EXPECT_FALSE(document.state()["saved"]);
    document.save();
    EXPECT_EQ(read_file(file()), document.text());
  }
}

TEST_F(OfAFile, AJournalOutlivesAChangeOfTheFile) {
  open().edit(fov(61), "");
  write(with_fov("30"));
  {
    Document document = open();
    EXPECT_EQ(document.text(), with_fov("61"));
    EXPECT_TRUE(document.state()["changed_on_disk"]);
    EXPECT_THROW(document.save(), Error);
    document.keep();
    EXPECT_FALSE(document.state()["changed_on_disk"]);
  }
  // The answer holds for a later process, and so do the steps.
  Document later = open();
  EXPECT_FALSE(later.state()["changed_on_disk"]);
  EXPECT_EQ(later.text(), with_fov("61"));
  later.undo();
  EXPECT_EQ(later.text(), kText);
  later.redo();
  later.save();
  EXPECT_EQ(read_file(file()), with_fov("61"));
}

TEST(Notes, AreTheCommentsAboveAndBehindAKeyOrAHeader) {
  const std::string text =
      "# of the file\n"
      "\n"
      "# A GUESS\n"
      "#  of two lines.\n"
      "[lens] # and behind\n"
      "model = \"pinhole\"\n"
      "\n"
      "# above\n"
      "vertical_fov_deg = 60\t#behind\n"
      "[camera]\n"
      "position_ned_m = [0, # north\n 0, -150] # 150 m high\n"
      "[[intruder]]  # of no key\n"
      "id = \"# none\"\n";
  const nlohmann::ordered_json wanted = {{"lens", "A GUESS of two lines. and behind"},
                                         {"lens.vertical_fov_deg", "above behind"},
                                         {"camera.position_ned_m", "150 m high"}};
  EXPECT_EQ(notes_of(tree_of(text, "s.toml").root, text), wanted);
}

// In a line of 130 kB: a walk from its start to each value would be one of billions of steps.
TEST(Tree, ValuesOfALongLineStandAtTheirBytes) {
  std::string text = "\xEF\xBB\xBFname = \"\u00fc\"\nall = [\"\u00fc\"";
  for (int k = 1; k < 20'000; ++k) text += ", " + std::to_string(k);
  const Tree tree = tree_of(text + "]\n", "s.toml");
  EXPECT_EQ(text.substr(tree.root.member("name")->begin, 4), "\"\u00fc\"");
  const std::vector<Node>& all = tree.root.member("all")->elements;
  ASSERT_EQ(all.size(), 20'000u);
  for (std::size_t k = 1; k < all.size(); ++k)
    ASSERT_EQ(text.substr(all[k].begin, all[k].end - all[k].begin), std::to_string(k));
}

TEST_F(OfAFile, ABegunSceneIsWrittenAtTheFirstSave) {
  const fs::path later = folder_.path() / "new.toml";
  Document document(later, kText, {});
  EXPECT_FALSE(document.state()["saved"]);
  EXPECT_FALSE(fs::exists(later));
  document.save();
  EXPECT_EQ(read_file(later), kText);
  EXPECT_THROW(Document(folder_.path() / "none.toml", std::nullopt, {}), Error);
}

TEST_F(OfAFile, AJournalThatBeganAnewIsReadAfterEveryStep) {
  Journal journal(file(), {});
  History history("", "");
  const auto text_read = [&journal] { return journal.read()->text(); };
  for (int k = 0; k < 6; ++k) {
    const std::string next(Journal::kMostBytes / 5, static_cast<char>('a' + k));
    const Edit edit{0, history.text(), next, ""};
    history.add(edit);
    journal.add(edit, history);
    EXPECT_TRUE(text_read() == history.text()) << "edit " << k;
  }
  while (history.undo_count() > 0) {
    history.undo();
    journal.undo(history);
    EXPECT_TRUE(text_read() == history.text()) << history.undo_count();
  }
  while (history.redo_count() > 0) {
    history.redo();
    journal.redo(history);
    EXPECT_TRUE(text_read() == history.text()) << history.redo_count();
  }
  journal.remove();
  history.undo();
  journal.undo(history);
  EXPECT_TRUE(text_read() == history.text());
  EXPECT_LE(fs::file_size(this->journal()), Journal::kMostBytes);
}

TEST_F(OfAFile, AFileThatIsNoJournalIsLeftAlone) {
  write_file(journal(), "{\"something\": 1}\n");
  EXPECT_THROW(open(), Error);
  EXPECT_TRUE(fs::exists(journal()));
}

}  // namespace
}  // namespace airtruth::document
