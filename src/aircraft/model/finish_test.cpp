// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "aircraft/model/mesh.h"

namespace airtruth::model {
namespace {

// Names that occur in the catalogue.
TEST(Finish, IsToldByWholeWords) {
  for (const char* name : {"glass",
                           "Glass23",
                           "glass.001",
                           "Grey40_Glass",
                           "BLACK50_Windows",
                           "Perspex.004",
                           "Cristal",
                           "verre2",
                           "canopy18"})
    EXPECT_EQ(finish_named(name), Finish::kGlass) << name;
  for (const char* name : {"Metal_01", "metal.001", "Chrome", "Cromo", "Titanio", "Mirror"})
    EXPECT_EQ(finish_named(name), Finish::kMetal) << name;
  for (const char* name :
       {"", "DefaultWhite", "ac3dmat1", "metalnegro", "glassmat20", "alutubing", "windowless", "7"})
    EXPECT_EQ(finish_named(name), Finish::kPaint) << name;
}

}  // namespace
}  // namespace airtruth::model
