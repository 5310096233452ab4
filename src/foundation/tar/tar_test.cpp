// SPDX-License-Identifier: Apache-2.0
#include "foundation/tar/tar.h"

#include <map>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "support/temporary_folder.h"

namespace airtruth::tar {
namespace {

using Files = std::map<std::string, std::string>;

Files files_of(const fs::path& archive, std::string_view ending = "") {
  Files files;
  each_file(archive, ending, [&](const std::string& name, const std::string& bytes) {
    EXPECT_TRUE(files.emplace(name, bytes).second);
  });
  return files;
}

std::string error_of(const fs::path& archive) {
  try {
    files_of(archive);
  } catch (const Error& error) {
    return error.message();
  }
  return "no error";
}

const Files kFiles = {{"a.json", "{}"},
                      {"a.jpg", std::string(512, '\xff')},
                      {"empty.json", ""},
                      {"folder/\u00e9 b.json", std::string(513, '\0')},
                      {std::string(100, 'n'), "just"},
                      {std::string(96, 'n') + ".json", "beyond"},
                      {std::string(700, 'm') + ".json", "far beyond"}};

class Tar : public testing::Test {
 protected:
  fs::path file() const { return folder_.path() / "a.tar"; }
  void write() const {
    Writer writer(file());
    for (const auto& [name, bytes] : kFiles) writer.add(name, bytes);
    writer.finish();
  }
  test_support::TemporaryFolder folder_;
};

TEST_F(Tar, ComesBack) {
  write();
  EXPECT_EQ(files_of(file()), kFiles);
  EXPECT_EQ(files_of(file(), ".jpg").size(), 1u);
  EXPECT_EQ(fs::file_size(file()) % 512, 0u);
}

TEST_F(Tar, IsWholeOrNotThere) {
  {
    Writer writer(file());
    writer.add("a", "b");
    EXPECT_FALSE(fs::exists(file()));
    EXPECT_EQ(writer.bytes(), 1024);
  }
  EXPECT_TRUE(fs::is_empty(folder_.path()));
  EXPECT_THROW(Writer(folder_.path() / "none" / "a.tar"), Error);
}

TEST_F(Tar, WhatIsCutOrChangedIsOneError) {
  write();
  const std::string whole = read_file(file());
  for (std::size_t size = 0; size < whole.size() - 1024; size += 97) {
    write_file(file(), whole.substr(0, size));
    EXPECT_THAT(error_of(file()), testing::StartsWith("ends wi")) << size;
  }
  for (const std::size_t at :
       {std::size_t{0}, std::size_t{124}, std::size_t{130}, std::size_t{500}}) {
    std::string changed = whole;
    changed[at] = '9';
    write_file(file(), changed);
    EXPECT_EQ(error_of(file()), "is no tar archive") << at;
  }
  EXPECT_EQ(error_of(folder_.path() / "none"), "cannot be opened");
  EXPECT_EQ(error_of(folder_.path()), "cannot be opened");
}

}  // namespace
}  // namespace airtruth::tar
