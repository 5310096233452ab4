// SPDX-License-Identifier: Apache-2.0
#include "foundation/sandbox/messages.h"

#include <string>

#include <gtest/gtest.h>

namespace airtruth::sandbox {
namespace {

TEST(Wire, BytesThatEndEarlyAreRefused) {
  WireWriter out;
  out.put(1.5);
  out.put_text("words");
  const std::string bytes = out.take();
  WireReader in(bytes);
  EXPECT_EQ(in.get<double>(), 1.5);
  EXPECT_EQ(in.get_text(5), "words");
  EXPECT_NO_THROW(in.expect_end());
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    WireReader cut(std::string_view(bytes).substr(0, size));
    EXPECT_THROW(
        {
          cut.get<double>();
          cut.get_text(5);
        },
        Error);
  }
  WireReader longer(bytes);
  longer.get<double>();
  EXPECT_THROW(longer.get_text(4), Error);
}

TEST(Wire, AnErrorKeepsItsPlaceAndItsOneLine) {
  const Error error = error_from_bytes(bytes_of(Error("two\nlines", {"a.obj", 3})));
  EXPECT_EQ(std::string(error.what()), "a.obj:3: two?lines");
}

}  // namespace
}  // namespace airtruth::sandbox
