// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <memory>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <toml++/toml.h>
#include <unistd.h>

#include "foundation/base/error.h"
#include "foundation/base/file_state.h"
#include "foundation/base/files.h"
#include "foundation/base/huge_pages.h"
#include "foundation/base/median.h"
#include "foundation/base/names.h"
#include "foundation/base/seed.h"
#include "foundation/base/text.h"
#include "support/error_of.h"
#include "support/temporary_folder.h"

namespace airtruth {
namespace {

class Files : public testing::Test {
 protected:
  Files() : folder_(fs::temp_directory_path() / ("airtruth_files_" + std::to_string(::getpid()))) {
    fs::create_directories(folder_);
  }
  ~Files() override { fs::remove_all(folder_); }
  fs::path folder_;
};

TEST(Error, SaysThePlaceThenTheFact) {
  const Error error("is -1; expected a positive number", {"scene.toml", 12, 3});
  EXPECT_STREQ(error.what(), "scene.toml:12:3: is -1; expected a positive number");
  EXPECT_EQ(error.message(), "is -1; expected a positive number");
  EXPECT_STREQ(Error("no place").what(), "no place");
  // A NUL, as in a cell of a foreign file, ends neither the text nor the name.
  const Error quoting(std::string_view("'8.5\0' is no number", 19), {{'a', '\0', 'b'}, 2});
  EXPECT_STREQ(quoting.what(), "a?b:2: '8.5?' is no number");
}

TEST(Words, StandBetweenBlanks) {
  EXPECT_THAT(words_in(" name  seed weight "), testing::ElementsAre("name", "seed", "weight"));
  EXPECT_TRUE(words_in(" ").empty());
}

TEST(TomlString, IsReadBackAsTheSameText) {
  std::string text = "\"quoted\" \\u0041 \u00e9\u4e2d\U0001f6e9\x7f";
  for (int c = 0; c < 0x20; ++c) text += static_cast<char>(c);
  EXPECT_EQ(toml::parse("v = " + toml_string(text))["v"].value<std::string>(), text);
  EXPECT_EQ(toml_string("a\tb\n\r"), R"("a\tb\n\u000D")");
}

TEST(ShellWord, IsOneArgumentOfTheShell) {
  const std::string text = "it's $HOME `a` \"b\" \\ *\n";
  const std::unique_ptr<FILE, int (*)(FILE*)> shell(
      ::popen(("printf %s " + shell_word(text)).c_str(), "r"), ::pclose);
  std::array<char, 100> said{};
  EXPECT_EQ(std::string(said.data(), std::fread(said.data(), 1, said.size(), shell.get())), text);
}

TEST(LineOf, CountsFromOneAndStaysWithinTheText) {
  EXPECT_EQ(line_of("", 0), 1);
  EXPECT_EQ(line_of("a\nb", 1), 1);
  EXPECT_EQ(line_of("a\nb", 2), 2);
  EXPECT_EQ(line_of("a\nb\n", 99), 3);
  EXPECT_EQ(line_of("a\nb", -1), 1);
}

TEST(EditDistance, IsDamerausOnKnownPairs) {
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3);
  EXPECT_EQ(edit_distance("ca", "ac"), 1);
  EXPECT_EQ(edit_distance("", "abc"), 3);
  EXPECT_EQ(edit_distance("same", "same"), 0);
}

TEST(NearestSpelling, FindsTheMeantWordOrNothing) {
  const std::vector<std::string> keys = {"speed_mps", "waypoints_ned_m", "aircraft"};
  EXPECT_EQ(nearest_spelling("speed_mp", keys), "speed_mps");
  EXPECT_EQ(nearest_spelling("Aircraft", keys), "aircraft");
  EXPECT_EQ(nearest_spelling("zzzzzz", keys), std::nullopt);
}

// The first values of SplitMix64 from state 0, as its authors' reference program prints them.
TEST(Pattern, StarsAndQuestionMarks) {
  EXPECT_TRUE(matches("*", ""));
  EXPECT_TRUE(matches("1*B737", "1LRB737"));
  EXPECT_FALSE(matches("1*B737", "1LRC172"));
  EXPECT_TRUE(matches("?LR*", "1LRB737"));
  EXPECT_FALSE(matches("?", ""));
  EXPECT_TRUE(matches("*a*b*c", "xxaxxbxxabc"));
  EXPECT_FALSE(matches(std::string(40, '*').append("b"), std::string(10000, 'a')));
}

TEST(Pattern, LetterCaseIsIgnoredWhereAsked) {
  EXPECT_FALSE(matches("C172*", "c172/news"));
  EXPECT_TRUE(matches("C172*", "c172/news", LetterCase::kIgnored));
  EXPECT_TRUE(matches("738/*ryanair", "738/738-Ryanair", LetterCase::kIgnored));
  EXPECT_FALSE(matches("C172", "c172/news", LetterCase::kIgnored));
  EXPECT_TRUE(contains_ignoring_case("c172/news", "C172"));
  EXPECT_TRUE(contains_ignoring_case("c172/news", ""));
  EXPECT_FALSE(contains_ignoring_case("c17", "C172"));
}

TEST(Random, IsSplitMix64) {
  Random random(0);
  EXPECT_EQ(random(), 0xe220a8397b1dcdafULL);
  EXPECT_EQ(random(), 0x6e789e6aa1b965f4ULL);
  EXPECT_EQ(random(), 0x06c45d188009454fULL);
}

TEST(Random, NormalHasMeanZeroAndVarianceOne) {
  Random random = Seed(7).stream("test");
  double sum = 0;
  double squares = 0;
  const int count = 100000;
  for (int i = 0; i < count; ++i) {
    const double x = random.normal();
    sum += x;
    squares += x * x;
  }
  EXPECT_NEAR(sum / count, 0, 0.02);
  EXPECT_NEAR(squares / count, 1, 0.03);
}

TEST(Seed, StreamsDiffer) {
  EXPECT_NE(Seed(1).stream("a")(), Seed(1).stream("b")());
  EXPECT_NE(Seed(1).stream("a")(), Seed(2).stream("a")());
  EXPECT_NE(Seed(1).stream("a", 1)(), Seed(1).stream("a", 2)());
  EXPECT_EQ(Seed(1).stream("a", 1)(), Seed(1).stream("a", 1)());
}

// FIPS 180-2, appendix B.1.
TEST_F(Files, Sha256OfAbcIsTheStandardsOwn) {
  const std::string expected = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
  EXPECT_EQ(sha256_of("abc"), expected);
  write_file(folder_ / "abc", "abc");
  EXPECT_EQ(sha256_of_file(folder_ / "abc"), expected);
}

TEST_F(Files, WriteReplacesWholeAndLeavesNoPart) {
  write_file(folder_ / "a.txt", "one");
  write_file(folder_ / "a.txt", "two");
  EXPECT_EQ(read_file(folder_ / "a.txt"), "two");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), fs::directory_iterator{}), 1);
}

TEST_F(Files, WriteIntoMissingFolderIsAnErrorThatNamesTheFile) {
  const fs::path file = folder_ / "no" / "a.txt";
  try {
    write_file(file, "x");
    FAIL() << "a file was written into a folder that does not exist";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr(file.string()));
  }
}

TEST_F(Files, ANormalPathNamesTheSameFile) {
  fs::create_directories(folder_ / "real/scenes");
  fs::create_directory(folder_ / "user");
  fs::create_directory_symlink(folder_ / "real/scenes", folder_ / "user/scenes");
  EXPECT_EQ(normal_path(folder_ / "user/scenes/../clip.mp4"),
            fs::canonical(folder_) / "real/clip.mp4");
  EXPECT_EQ(normal_path(folder_ / "user/scenes/./clip.mp4"), folder_ / "user/scenes/clip.mp4");
  EXPECT_EQ(normal_path(folder_ / "real/scenes/../../user/scenes"), folder_ / "user/scenes");
  EXPECT_EQ(normal_path("a/../b.mp4"), "b.mp4");
  EXPECT_EQ(absolute_path("a/../set/"), fs::current_path() / "set");
  EXPECT_EQ(absolute_path("/"), "/");
}

TEST_F(Files, AFolderThatHoldsOthersFilesIsRefused) {
  const fs::path folder = folder_ / "made";
  EXPECT_NO_THROW(refuse_foreign(folder, {"record.json"}));
  fs::create_directory(folder);
  write_file(folder / ".left", "by a run that was killed");
  EXPECT_NO_THROW(refuse_foreign(folder, {"record.json"}));
  write_file(folder / "report.html", "of somebody else");
  EXPECT_EQ(test_support::error_of([&] {
              refuse_foreign(folder, {"record.json", "other.json"});
            }),
            folder.string() +
                ": exists and is not empty, and holds no record.json or other.json; expected a "
                "new folder");
  EXPECT_EQ(test_support::error_of([&] { refuse_foreign(folder); }),
            folder.string() + ": exists and is not empty; expected a new folder");
  write_file(folder / "record.json", "{}");
  EXPECT_NO_THROW(refuse_foreign(folder, {"other.json", "record.json"}));
}

TEST_F(Files, ReadRefusesWhatIsMissingAFolderOrTooLarge) {
  EXPECT_THROW(read_file(folder_ / "none"), Error);
  EXPECT_THROW(read_file(folder_), Error);
  write_file(folder_ / "ten", "0123456789");
  EXPECT_THROW(read_file(folder_ / "ten", 9), Error);
  EXPECT_EQ(read_file(folder_ / "ten", 10).size(), 10u);
}

TEST(Utf8, FindsTheFirstFault) {
  EXPECT_EQ(utf8_fault("plain, \xc3\xa9, \xe2\x82\xac, \xf0\x9f\x98\x80"), std::string_view::npos);
  EXPECT_EQ(utf8_fault("ab\xff"), 2u);
  EXPECT_EQ(utf8_fault("\xc0\xaf"), 0u);       // overlong
  EXPECT_EQ(utf8_fault("a\xed\xa0\x80"), 1u);  // surrogate
  EXPECT_EQ(utf8_fault("a\xe2\x82"), 1u);      // cut short
}

TEST(Median, IsTheUpperOfTwoMiddleValues) {
  EXPECT_EQ(median(std::vector<double>{3}), 3);
  EXPECT_EQ(median(std::vector<double>{5, 1, 3}), 3);
  EXPECT_EQ(median(std::vector<double>{7, 1, 5, 3}), 5);
  EXPECT_EQ(median(std::vector<std::uint8_t>{255, 0, 254}), 254);
  const std::vector<float> kept{2, 1};
  EXPECT_EQ(median(kept), 2.0F);
  EXPECT_EQ(kept, (std::vector<float>{2, 1}));
  EXPECT_EQ(median_or_0(std::vector<float>{}), 0.0F);
  EXPECT_EQ(median_or_0(kept), 2.0F);
}

TEST(PartPath, HidesAndKeepsTheExtension) {
  EXPECT_EQ(part_path("out/a.mp4"), fs::path("out/.a.part.mp4"));
  const std::string longest = std::string(251, 'n') + ".png";
  EXPECT_EQ(part_path(longest), fs::path("." + std::string(245, 'n') + ".part.png"));
}

TEST(WriteFile, ANameThatHoldsANulIsRefused) {
  const test_support::TemporaryFolder folder;
  const fs::path file = folder.path() / std::string("a\0b", 3);
  for (int i = 0; i < 2; ++i) EXPECT_THROW(write_file(file, "x"), Error);
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

TEST(WriteFile, OfWritersAtOnceTheBytesOfOneStay) {
  const test_support::TemporaryFolder folder;
  const fs::path file = folder / "a.txt";
  for (int round = 0; round < 50; ++round) {
    std::vector<std::thread> writers;
    for (char letter = 'a'; letter < 'i'; ++letter)
      writers.emplace_back([&, letter] {
        write_file(file, std::string(static_cast<std::size_t>(letter) * 1000, letter));
      });
    for (std::thread& writer : writers) writer.join();
    const std::string found = read_file(file);
    EXPECT_EQ(found, std::string(static_cast<std::size_t>(found.at(0)) * 1000, found.at(0)));
    EXPECT_EQ(std::distance(fs::directory_iterator(folder / "."), fs::directory_iterator()), 1);
  }
}

TEST(WriteFile, APartOfADeadWriterIsReplacedAndThatOfALivingOneIsNot) {
  const test_support::TemporaryFolder folder;
  const fs::path file = folder / "a.txt";
  { std::ofstream(part_path(file)) << "dead"; }
  write_file(file, "one");
  EXPECT_FALSE(fs::exists(part_path(file)));
  { std::ofstream(part_path(file)) << "living"; }
  const RunLock living(part_path(file), file, {});
  write_file(file, "two");
  EXPECT_EQ(read_file(file), "two");
  EXPECT_EQ(read_file(part_path(file)), "living");
}

TEST(RunLock, KeepsASecondRunAway) {
  const test_support::TemporaryFolder folder;
  const fs::path place = folder / ".";
  {
    const RunLock one(place, place, {});
    EXPECT_THROW(RunLock(place, place, {}), Error);
  }
  const RunLock shared(place, place, {}, Sharing::kShared);
  EXPECT_NO_THROW(RunLock(place, place, {}, Sharing::kShared));
  EXPECT_THROW(RunLock(place, place, {}), Error);
}

// Whether the kernel notes for the mapping of an address that huge pages are asked for.
bool is_asked_for(const void* address) {
  const auto wanted = reinterpret_cast<std::uintptr_t>(address);
  std::ifstream maps("/proc/self/smaps");
  bool within = false;
  for (std::string line; std::getline(maps, line);) {
    std::uintptr_t from = 0, to = 0;
    char dash = 0;
    if (std::istringstream words(line); words >> std::hex >> from >> dash >> to && dash == '-')
      within = from <= wanted && wanted < to;
    if (within && line.starts_with("VmFlags:")) return line.find(" hg") != std::string::npos;
  }
  return false;
}

TEST(HugePages, AreAskedForWhereWholeOnesLie) {
  if (::access("/sys/kernel/mm/transparent_hugepage/enabled", R_OK) != 0)
    GTEST_SKIP() << "this kernel has no huge pages";
  constexpr std::size_t kHuge = 2 << 20;
  constexpr std::size_t kBytes = 8 * kHuge;
  void* const memory =
      ::mmap(nullptr, kBytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  ASSERT_NE(memory, MAP_FAILED);
  char* const begin = static_cast<char*>(memory) + 1000;
  ask_for_huge_pages(begin, kHuge - 1);  // holds no whole page
  EXPECT_FALSE(is_asked_for(begin + kHuge / 2));
  ask_for_huge_pages(begin, kBytes - 2000);
  EXPECT_TRUE(is_asked_for(begin + kBytes / 2));
  EXPECT_FALSE(is_asked_for(memory)) << "outside the asked part";
  ::munmap(memory, kBytes);
}

}  // namespace
}  // namespace airtruth
