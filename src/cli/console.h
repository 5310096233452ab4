// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <stop_token>
#include <string>

#include "foundation/base/log.h"

// All output of the program passes through this file. Results go to standard output; warnings,
// errors and progress go to standard error. Progress appears only on a terminal, not in a pipe.
namespace airtruth::cli {

struct ConsoleOptions {
  bool quiet = false;  // only warnings and errors
  // True: standard error gets one JSON object per line in place of text.
  bool json_log = false;
};

class Console {
 public:
  explicit Console(const ConsoleOptions& options);

  void progress(const std::string& stage,
                std::int64_t done,
                std::int64_t total,
                const std::string& unit = "frames");
  void end_progress();
  void warning(const std::string& message);
  void error(const std::string& message);
  // Reports that the run was interrupted, once for the whole process.
  void interrupted();
  // The same in words of the command's own, for one that a user ends so; nothing when quiet.
  void ended(const std::string& words);
  // Reports what the run made; prints nothing when quiet.
  void result(const std::string& message);
  // Writes the text unchanged to standard output. Throws Error where the write fails, except where
  // the reader has closed the pipe: then the text is dropped.
  void print(const std::string& text);
  Warn warn() {
    return [this](const std::string& message) { warning(message); };
  }

 private:
  void log(const char* level, const std::string& message);

  ConsoleOptions options_;
  bool terminal_ = false;
  bool line_open_ = false;
  bool reader_left_ = false;
  std::string stage_;
  std::chrono::steady_clock::time_point start_;
  std::chrono::steady_clock::time_point last_;
};

inline constexpr int kInterrupted = 130;  // exit code of an interrupted run

// Opens /dev/null as standard input, output or error where the caller closed it, so that no file
// opened later gets its number and receives messages. Also makes writing to a pipe that is closed
// at its other end, and beyond the limit of a file's size, an error of the write. It is called
// before any file is opened.
void open_standard_streams();

// Turns SIGINT, SIGTERM and SIGHUP into a request to stop. Where the process has not ended within
// two seconds, or a second signal arrives, unfinished output is removed and the process ends with
// exit code 130. main() creates it first, before any thread, so that every thread of its own
// inherits the blocked signals; threads that libraries began before hand them on.
class StopOnSignal {
 public:
  StopOnSignal();
  std::stop_token token() const { return source_.get_token(); }

 private:
  std::stop_source source_;
};

}  // namespace airtruth::cli
