// SPDX-License-Identifier: Apache-2.0
#include "foundation/disk_cache/disk_cache.h"

#include <chrono>
#include <cstdlib>

#include <gtest/gtest.h>

#include "foundation/base/files.h"
#include "support/environment_variable.h"
#include "support/temporary_folder.h"

namespace airtruth::disk_cache {
namespace {

const Key kKey = Key("test").add("content").add(1.5);

class DiskCache : public testing::Test {
 protected:
  const test_support::TemporaryFolder folder_;
  const Cache cache_{folder_ / "entries"};
  const fs::path entry_ = folder_ / "entries" / kKey.name();
};

TEST_F(DiskCache, WhatIsKeptIsFound) {
  EXPECT_FALSE(cache_.find(kKey));
  const std::string body("a\0b\n", 4);
  cache_.keep(kKey, body);
  EXPECT_EQ(cache_.find(kKey), body);
  cache_.keep(kKey, "another");
  EXPECT_EQ(cache_.find(kKey), "another");
}

TEST_F(DiskCache, WhatIsDamagedCountsAsMissing) {
  cache_.keep(kKey, "body");
  const std::string whole = read_file(entry_);
  std::string changed = whole;
  changed[10] = changed[10] == '0' ? '1' : '0';
  for (const std::string& bad : {std::string(),
                                 whole.substr(0, 30),
                                 whole.substr(0, whole.size() - 1),
                                 whole + "x",
                                 changed}) {
    write_file(entry_, bad);
    EXPECT_FALSE(cache_.find(kKey)) << bad;
  }
  write_file(entry_, whole);
  EXPECT_TRUE(cache_.find(kKey));
}

TEST_F(DiskCache, WhatItsReaderRefusesCountsAsMissing) {
  cache_.keep(kKey, "12");
  const auto number = [](const std::string& text) {
    if (text != "12") throw Error("is no 12");
    return 12;
  };
  EXPECT_EQ(cache_.find(kKey, number), 12);
  cache_.keep(kKey, "13");
  EXPECT_EQ(cache_.find(kKey, number), std::nullopt);
}

TEST_F(DiskCache, AFolderThatCannotBeWrittenIsNoError) {
  write_file(folder_ / "file", "no folder");
  for (const Cache& cache : {Cache(), Cache(folder_ / "file")}) {
    cache.keep(kKey, "body");
    EXPECT_FALSE(cache.find(kKey));
    EXPECT_EQ(cache.lock(kKey, {}), nullptr);
  }
}

TEST_F(DiskCache, AFolderThatOthersCanWriteIsNotUsed) {
  cache_.keep(kKey, "body");
  for (const fs::perms others : {fs::perms::group_write, fs::perms::others_write}) {
    fs::permissions(folder_ / "entries", fs::perms::owner_all | others);
    EXPECT_FALSE(cache_.find(kKey));
    EXPECT_EQ(cache_.lock(kKey, {}), nullptr);
    EXPECT_EQ(refused_folder(), folder_ / "entries");
  }
  fs::permissions(folder_ / "entries", fs::perms::owner_all | fs::perms::group_read);
  EXPECT_EQ(cache_.find(kKey), "body");
  fs::create_directory_symlink(folder_ / "entries", folder_ / "link");
  EXPECT_FALSE(Cache(folder_ / "link").find(kKey));
}

TEST(DiskCacheFolder, IsTheUsersOrNone) {
  const test_support::EnvironmentVariable cache("XDG_CACHE_HOME", "/c"), home("HOME", "/h");
  EXPECT_EQ(user_folder("k"), "/c/airtruth/k");
  ::setenv("XDG_CACHE_HOME", "c", 1);
  EXPECT_EQ(user_folder("k"), "/h/.cache/airtruth/k");
  ::unsetenv("HOME");
  EXPECT_EQ(user_folder("k"), "");
}

TEST_F(DiskCache, EntriesThatNobodyUsesAreRemoved) {
  const Key other = Key("other");
  cache_.keep(kKey, "body");
  const auto now = fs::file_time_type::clock::now();
  write_file(folder_ / "entries" / "note", "of somebody else");
  for (const auto& file : fs::directory_iterator(folder_ / "entries"))
    fs::last_write_time(file, now - std::chrono::days(89));
  cache_.keep(other, "body");
  EXPECT_TRUE(fs::exists(entry_));
  for (const auto& file : fs::directory_iterator(folder_ / "entries"))
    fs::last_write_time(file, now - std::chrono::days(91));
  EXPECT_TRUE(cache_.find(kKey)) << "which is a use";
  cache_.keep(Key("third"), "body");
  EXPECT_TRUE(fs::exists(entry_));
  EXPECT_FALSE(cache_.find(other));
  EXPECT_TRUE(fs::exists(folder_ / "entries" / "note"));
}

TEST(DiskCacheKey, IsAnotherForAnotherContent) {
  EXPECT_EQ(kKey.name(), Key("test").add("content").add(1.5).name());
  EXPECT_EQ(kKey.name().size(), 64u);
  EXPECT_NE(Key("test").add("content").add(1.25).name(), kKey.name());
  EXPECT_NE(Key("other").add("content").add(1.5).name(), kKey.name());
  EXPECT_NE(Key("test").add("ab").add("c").name(), Key("test").add("a").add("bc").name());
}

}  // namespace
}  // namespace airtruth::disk_cache
