// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

namespace airtruth {

// A place in what the user gave. line and column count from 1; 0 means "not known".
struct Where {
  std::string file;
  int line = 0;
  int column = 0;
};

// "scene.toml:12:3", "scene.toml", or "" where nothing is known.
std::string to_string(const Where& where);

// Something is wrong with what the user gave, or with the world around the program (a full disk).
// The message is one line: what was found, what was expected, and what to do. The program ends with
// exit code 2.
//
//   throw Error("focal_px is -480; expected two positive numbers", {"scene.toml", 12, 3});
//   what() == "scene.toml:12:3: focal_px is -480; expected two positive numbers"
class Error : public std::runtime_error {
 public:
  explicit Error(std::string_view message, Where where = {});
  const Where& where() const { return where_; }
  // The message without the place.
  const std::string& message() const { return message_; }

 private:
  std::string message_;
  Where where_;
};

// The user asked to stop (Ctrl-C, SIGTERM). The program ends with exit code 130.
class Interrupted : public std::runtime_error {
 public:
  Interrupted() : std::runtime_error("interrupted") {}
};

// Checks an invariant of the program. A false condition is a bug: the function throws
// std::logic_error, and the program ends with exit code 1. Release builds keep the check.
void check(bool condition, std::string_view what);

}  // namespace airtruth
