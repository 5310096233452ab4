// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include <gtest/gtest.h>

#include "aircraft/fleet/fleet.h"
#include "foundation/base/error.h"

namespace airtruth::fleet {
namespace {

TEST(LeftOut, WhatIsNotOfferedIsInThePackageAndCannotBeDrawn) {
  ASSERT_FALSE(left_out().empty());
  for (const auto& [name, reason] : left_out()) {
    EXPECT_FALSE(reason.empty()) << name;
    EXPECT_NO_THROW(find_aircraft(name)) << name;
    if (reason.starts_with("no aircraft")) continue;
    EXPECT_THROW(load_aircraft(name), Error) << name;
  }
}

TEST(LeftOut, ItIsNeitherListedNorDrawnNorSuggested) {
  for (const Entry& entry : list_aircraft()) EXPECT_FALSE(left_out().contains(entry.name));
  const auto fitting = aircraft_fitting("Ferry/*");
  EXPECT_TRUE(fitting.empty());
  const auto all = aircraft_fitting("767/*");
  EXPECT_EQ(std::count(all.begin(), all.end(), "767/767-Rossiya"), 0);
  EXPECT_EQ(std::count(all.begin(), all.end(), "767/767-ANA"), 1);
}

}  // namespace
}  // namespace airtruth::fleet
