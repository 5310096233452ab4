// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <stdexcept>
#include <string>
#include <string_view>

#include <airtruth/export.h>

namespace airtruth {

// A place in what the user gave. line and column count from 1; 0 means "not known".
struct Where {
  std::string file;
  int line = 0;
  int column = 0;
};

// Something is wrong with what the user gave, or with the world around the program (a full disk).
// The message is one line: what was found, what was expected, and what to do. The program airtruth
// ends with exit code 2.
//
//   throw Error("focal_px is -480; expected two positive numbers", {"scene.toml", 12, 3});
//   what() == "scene.toml:12:3: focal_px is -480; expected two positive numbers"
class AIRTRUTH_API Error : public std::runtime_error {
 public:
  explicit Error(std::string_view message, Where where = {});
  ~Error() override;
  Error(const Error&) = default;
  Error& operator=(const Error&) = default;
  const Where& where() const { return where_; }
  // The message without the place.
  const std::string& message() const { return message_; }

 private:
  std::string message_;
  Where where_;
};

// A caller asked to stop (a std::stop_token; in the program airtruth: Ctrl-C or SIGTERM, and the
// exit code is 130).
class AIRTRUTH_API Interrupted : public std::runtime_error {
 public:
  Interrupted();
  ~Interrupted() override;
  Interrupted(const Interrupted&) = default;
  Interrupted& operator=(const Interrupted&) = default;
};

// The library never prints: it passes one-line warnings to its caller through this function. An
// empty function discards them.
using Warn = std::function<void(const std::string& message)>;

}  // namespace airtruth
