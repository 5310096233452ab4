// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <stop_token>
#include <string>

#include "foundation/base/log.h"

// All that the program prints goes through here. Results go to standard output; warnings, errors
// and progress to standard error. Progress is drawn on a terminal alone and is quiet in a pipe.
namespace airtruth::cli {

struct ConsoleOptions {
  bool quiet = false;     // warnings and errors alone
  bool json_log = false;  // one JSON object a line on standard error, in place of text
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
  void interrupted();  // the error of a run that was interrupted; once for the whole process
  void result(const std::string& message);  // what the run made; nothing when quiet
  // To standard output as it stands. Error where it cannot be written; but nothing where its reader
  // has left, who wants no more of it.
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

inline constexpr int kInterrupted = 130;  // the exit code

// Opens /dev/null as standard input, output or error where the caller closed it, so that no file
// that is opened later takes its number and is written over by messages; and makes a pipe that is
// closed at its other end an error of the write. Called before anything is opened.
void open_standard_streams();

// Turns SIGINT, SIGTERM and SIGHUP into a request to stop. Where the process has not ended within
// two seconds, or a second signal comes, what is unfinished is undone and the process ends with
// 130. Made first thing in main, before any thread, so that every thread inherits the blocked
// signals.
class StopOnSignal {
 public:
  StopOnSignal();
  std::stop_token token() const { return source_.get_token(); }

 private:
  std::stop_source source_;
};

}  // namespace airtruth::cli
