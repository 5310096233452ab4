// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <optional>
#include <stdexcept>
#include <stop_token>
#include <string>
#include <string_view>

#include <sys/types.h>

#include "foundation/base/descriptor.h"
#include "foundation/base/error.h"
#include "foundation/base/unfinished.h"

namespace airtruth::process {

using Clock = std::chrono::steady_clock;
// The time so many seconds from now.
Clock::time_point in(double seconds);

// Thrown where a runner can give no more answers: its process ended, did not answer in time, or
// violated its protocol; its network failed. The text goes on after the runner's name.
class Failure : public std::runtime_error {
 public:
  explicit Failure(std::string_view what) : std::runtime_error(without_nul(what)) {}
};

// How long a runner's process may take, in seconds, and what ends every wait for it.
struct Limits {
  double start_s = 30;   // for its start
  double answer_s = 30;  // for each answer
  std::stop_token stop;
};

// The process of a tracker, or of a detector: a shell command in its own process group, so that all
// processes that it starts end with it. Its output is read at all times, so that neither side
// blocks the other. Of output other than messages, at most kMaxLog bytes are kept. A stop ends
// every wait with Interrupted.
class Child {
 public:
  static constexpr std::size_t kMaxLog = std::size_t{1} << 20;  // bytes
  // The longest message in bytes: a picture of 16 megapixels in base64.
  static constexpr std::size_t kMaxBytes = std::size_t{64} << 20;
  enum class Transport {
    kStandard,  // its standard input and output
    kSocket     // it connects to 127.0.0.1 at the port TRAX_SOCKET
  };

  // Lines of its output that begin with `prefix` are messages. Throws Error where no process can be
  // created.
  Child(const std::string& command,
        Transport transport,
        std::stop_token stop,
        std::string_view prefix);
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  // Ends the process with SIGTERM, then SIGKILL, sent to its group alone.
  ~Child();

  // Throws Failure after the deadline, and where the process has ended.
  void write(std::string_view bytes, Clock::time_point deadline);
  // Returns the next message, without its line end; other output goes to the log.
  std::string read(Clock::time_point deadline);
  // Returns a message that has already arrived; never waits.
  std::optional<std::string> read_if_there();
  // Waits until the process ends, at most until the deadline.
  void wait(Clock::time_point deadline);

  // The time just before the last bytes were handed to the process. It is taken before the write,
  // because the process may answer before this thread runs again.
  Clock::time_point asked_at() const { return asked_at_; }
  const std::string& log() const { return log_; }

 private:
  void accept(Clock::time_point deadline);
  void pump(Clock::time_point deadline, std::string_view* unsent);
  void drain(Descriptor& file);
  void take_lines();
  std::optional<std::string> line_from_input();
  void keep(std::string_view text);
  std::string ending();
  bool ended();

  std::stop_token stop_;
  std::string prefix_;
  pid_t process_ = -1;
  std::optional<Unfinished> unfinished_;  // its process group is ended
  std::optional<int> status_;
  Descriptor listening_;
  Descriptor to_;
  Descriptor from_;     // protocol; with a socket, it and to_ are two descriptors of that
  Descriptor chatter_;  // standard error; with a socket, standard output too
  std::string input_;
  // Number of bytes of input_ that were searched for a line's end.
  std::size_t searched_ = 0;
  // True within a line that is no message and too long to hold.
  bool skips_line_ = false;
  Clock::time_point asked_at_;
  std::string log_;
};

}  // namespace airtruth::process
