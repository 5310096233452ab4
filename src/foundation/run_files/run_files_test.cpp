// SPDX-License-Identifier: Apache-2.0
#include "foundation/run_files/run_files.h"

#include <thread>

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/run_files/memory_place.h"
#include "support/temporary_folder.h"

namespace airtruth {
namespace {

class RunFilesTest : public testing::Test {
 protected:
  fs::path file(const char* name, const char* text = "old") const {
    write_file(folder_ / name, text);
    return folder_ / name;
  }
  static std::string fault(const RunFiles& files) {
    try {
      files.check();
    } catch (const Error& error) {
      return error.message();
    }
    return "";
  }
  // Number of names in the folder, hidden ones too.
  std::ptrdiff_t names() const {
    return std::distance(fs::directory_iterator(folder_ / "."), fs::directory_iterator());
  }

  const test_support::TemporaryFolder folder_;
};

TEST_F(RunFilesTest, AnOutputIsNoInputUnderAnyOfItsNames) {
  const fs::path a = file("a.mp4");
  fs::create_symlink(a, folder_ / "link.mp4");
  fs::create_hard_link(a, folder_ / "hard.mp4");
  fs::create_directory(folder_ / "d");
  for (const fs::path& name :
       {a, folder_ / "d" / ".." / "a.mp4", folder_ / "link.mp4", folder_ / "hard.mp4"})
    EXPECT_NE(fault(RunFiles().reads(a).writes(name, true)), "") << name;
  EXPECT_EQ(fault(RunFiles().reads(a).writes(folder_ / "b.mp4", false)), "");
}

TEST_F(RunFilesTest, AFileOfANumberedPatternIsAnInput) {
  const fs::path first = file("f_0001.png");
  const fs::path other = file("plot.png");
  const fs::path pattern = folder_ / "f_%04d.png";
  EXPECT_NE(fault(RunFiles().reads(pattern).writes(first, true)), "");
  EXPECT_EQ(fault(RunFiles().reads(pattern).writes(other, true)), "");
}

TEST_F(RunFilesTest, OneInputOfAListIsGivenOnce) {
  const fs::path a = file("a.mp4");
  const fs::path b = file("b.mp4");
  fs::create_symlink(a, folder_ / "link.mp4");
  EXPECT_NO_THROW(refuse_twice({a, b, folder_ / "none.mp4"}));
  for (const fs::path& again : {a, folder_ / "." / "a.mp4", folder_ / "link.mp4"})
    EXPECT_THROW(refuse_twice({a, b, again}), Error) << again;
}

TEST_F(RunFilesTest, OutputsDiffer) {
  EXPECT_NE(fault(RunFiles().writes(folder_ / "x", false).writes(folder_ / "." / "x", false)), "");
  EXPECT_EQ(fault(RunFiles().writes(folder_ / "x", false).writes(folder_ / "y", false)), "");
}

TEST_F(RunFilesTest, WhatLiesInAFolderThatIsReadIsNotReplaced) {
  fs::create_directory(folder_ / "set");
  const fs::path inside = file("set/truth.jsonl");
  EXPECT_NE(fault(RunFiles().reads(folder_ / "set").writes(inside, true)), "");
  EXPECT_EQ(fault(RunFiles().reads(folder_ / "set").writes(folder_ / "set/new", true)), "");
  EXPECT_NE(fault(RunFiles().reads(inside).replaces(folder_ / "set")), "");
  EXPECT_EQ(fault(RunFiles().reads(inside).replaces(folder_ / "se")), "");
}

TEST_F(RunFilesTest, WithoutCommitNothingStays) {
  const fs::path a = file("a");
  {
    RunFiles files;
    files.writes(a, true).writes(folder_ / "b", false).writes_into(folder_ / "new" / "er");
    files.begin();
    files.write(a, [](const fs::path& at) { write_file(at, "new"); });
    files.write(folder_ / "b", [](const fs::path& at) { write_file(at, "new"); });
    EXPECT_EQ(read_file(a), "old");
  }
  EXPECT_EQ(read_file(a), "old");
  EXPECT_EQ(names(), 1);
}

TEST_F(RunFilesTest, AFolderOfOthersIsNotWrittenInto) {
  const fs::path page = file("page.html");
  const auto into = [&] { RunFiles().writes_into(folder_ / ".", {"record.json"}); };
  EXPECT_THROW(into(), Error);
  file(".airtruth.part-0");  // a run was killed while it moved the page into place
  EXPECT_NO_THROW(into());
  EXPECT_THROW(RunFiles().writes_into(folder_ / "."), Error);
}

// Were its files moved one by one, a run that is killed meanwhile would leave a part of a set.
TEST_F(RunFilesTest, ANewFolderOfAnOutputIsMovedInOneStep) {
  const auto number = [](const fs::path& at) {
    struct stat found {};
    EXPECT_EQ(::stat(at.c_str(), &found), 0);
    return found.st_ino;
  };
  for (const char* name : {"a", "b"}) {
    RunFiles files;
    files.writes_into(folder_ / "set", {"sequences"});
    files.begin();
    ino_t written = 0;
    files.write(folder_ / "set", [&](const fs::path& at) {
      fs::create_directory(at / "sequences");
      write_file(at / "sequences" / name, name);
      written = number(at / "sequences");
    });
    files.commit();
    EXPECT_EQ(number(folder_ / "set/sequences") == written, *name == 'a');
    EXPECT_EQ(read_file(folder_ / "set/sequences" / name), name);
  }
  EXPECT_EQ(read_file(folder_ / "set/sequences/a"), "a");
}

TEST_F(RunFilesTest, AFaultNamesTheOutput) {
  RunFiles files;
  const fs::path a = folder_ / "a";
  files.writes(a, false);
  files.begin();
  try {
    files.write(a, [](const fs::path& at) { throw Error("is full", {at.string()}); });
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(std::string(error.what()), a.string() + ": is full");
  }
}

// Each set is of two files, and each writer's files hold its number.
TEST_F(RunFilesTest, ASetOfFilesIsOfOneWriter) {
  for (int round = 0; round < 20; ++round) {
    std::vector<std::thread> writers;
    for (int k = 0; k < 8; ++k)
      writers.emplace_back([&, k] {
        RunFiles files;
        for (const char* name : {"x", "y"}) files.writes(folder_ / name, true);
        files.begin();
        for (const char* name : {"x", "y"})
          files.write(folder_ / name,
                      [&](const fs::path& at) { write_file(at, std::to_string(k)); });
        files.commit();
      });
    for (std::thread& writer : writers) writer.join();
    EXPECT_EQ(read_file(folder_ / "x"), read_file(folder_ / "y"));
    EXPECT_EQ(names(), 2);
  }
}

TEST_F(RunFilesTest, WhatAKilledRunLeftIsRemovedAndALivingRunsIsNot) {
  const fs::path a = folder_ / "a";
  const pid_t child = ::fork();
  if (child == 0) {
    RunFiles files;
    files.writes(a, false);
    files.begin();
    ::_exit(0);  // as by SIGKILL: no destructor runs
  }
  ::waitpid(child, nullptr, 0);
  EXPECT_EQ(names(), 1);
  RunFiles living;
  living.writes(a, false);
  living.begin();
  EXPECT_EQ(names(), 1);
  {
    RunFiles other;
    other.writes(folder_ / "b", false);
    other.begin();
    EXPECT_EQ(names(), 2);
  }
  EXPECT_EQ(names(), 1);
  living.write(a, [](const fs::path& at) { write_file(at, "whole"); });
  living.commit();
  EXPECT_EQ(read_file(a), "whole");
}

// Nobody makes a file in /proc, root neither.
TEST(MemoryPlace, LiesInTheTemporaryFolderWhereThereIsNoMemoryToWrite) {
  for (const PlaceKind kind : {PlaceKind::kFile, PlaceKind::kFolder}) {
    fs::path at;
    {
      const MemoryPlace place(kind, "a test", "/proc");
      at = place.path();
      EXPECT_TRUE(fs::equivalent(at.parent_path(), fs::temp_directory_path())) << at;
      EXPECT_TRUE(fs::exists(at));
    }
    EXPECT_FALSE(fs::exists(at));
  }
}

}  // namespace
}  // namespace airtruth
