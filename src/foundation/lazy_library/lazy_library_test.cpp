// SPDX-License-Identifier: Apache-2.0
#include "foundation/lazy_library/lazy_library.h"

#include <filesystem>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "foundation/base/error.h"
#include "support/environment_variable.h"

namespace airtruth::lazy_library {
namespace {

std::string reason_of(const Library& library, const std::string& symbol) {
  try {
    symbol_of(library, symbol);
    return {};
  } catch (const Error& error) {
    return error.message();
  }
}

// The C library's mathematics stand for a library of ours, in the place that the variable names.
TEST(LazyLibrary, GivesTheAddressOfASymbol) {
  const Library library{"no-such.so", "AIRTRUTH_TEST_LATE", "the tested part"};
  const test_support::EnvironmentVariable stated("AIRTRUTH_TEST_LATE", "libm.so.6");
  EXPECT_EQ(reinterpret_cast<double (*)(double)>(symbol_of(library, "fabs"))(-3), 3);
  EXPECT_THAT(reason_of(library, "no_such_function"), testing::HasSubstr("no_such_function"));
}

TEST(LazyLibrary, IsNamedWhereItIsNotThere) {
  EXPECT_THAT(reason_of({"no-such.so", "AIRTRUTH_TEST_LATE", "the tested part"}, "fabs"),
              testing::AllOf(testing::HasSubstr("no-such.so, the tested part, cannot be loaded"),
                             testing::HasSubstr("set AIRTRUTH_TEST_LATE to it")));
}

// Of another build is what lacks the name of this one, though it has the symbol.
TEST(LazyLibrary, OfAnotherBuildIsRefused) {
  EXPECT_THAT(of_build("fabs"), testing::MatchesRegex("fabs_[0-9a-f]*"));
  EXPECT_NE(of_build("fabs"), "fabs_");
  const test_support::EnvironmentVariable stated("AIRTRUTH_TEST_LATE", "libm.so.6");
  EXPECT_THAT(reason_of({"no-such.so", "AIRTRUTH_TEST_LATE", "the tested part"}, of_build("fabs")),
              testing::AllOf(testing::HasSubstr("cannot be loaded"),
                             testing::HasSubstr("install airtruth whole")));
}

TEST(Places, OfAChildAndOfDataAreBesideTheProgramFirstAndThenInItsPrefix) {
  const std::filesystem::path own = std::filesystem::read_symlink("/proc/self/exe").parent_path();
  const auto children = places_of("child");
  const auto data = data_places_of("of/data.txt");
  ASSERT_GE(children.size(), 3u);
  ASSERT_GE(data.size(), 3u);
  EXPECT_EQ(children[0], own / "child");
  EXPECT_EQ(children[1], own.parent_path() / "libexec/airtruth/child");
  EXPECT_EQ(data[0], own / "of/data.txt");
  EXPECT_EQ(data[1], own.parent_path() / "share/airtruth/data/of/data.txt");
  EXPECT_TRUE(data.back().string().ends_with("share/airtruth/data/of/data.txt"));
}

}  // namespace
}  // namespace airtruth::lazy_library
