// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>

#include <sys/types.h>

#include "benchmark/trax/message.h"
#include "foundation/base/unfinished.h"

namespace airtruth::trax {

using Clock = std::chrono::steady_clock;

// The child ended, hung, or said what it may not.
class ChildError : public ProtocolError {
 public:
  using ProtocolError::ProtocolError;
};

// A tracker's process: a shell command in a process group of its own, so that all that it starts
// ends with it. What it writes is read at all times, so that it never blocks on us nor we on it; of
// what is no message at most kMostLog bytes are kept. A stop ends every wait by Interrupted.
class Child {
 public:
  static constexpr std::size_t kMostLog = std::size_t{1} << 20;
  enum class Transport {
    kStandard,  // its standard input and output
    kSocket     // it connects to 127.0.0.1 at the port TRAX_SOCKET
  };

  // Error where no process can be made.
  Child(const std::string& command, Transport transport, std::stop_token stop);
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  ~Child();  // ends it: SIGTERM, then SIGKILL, to its group alone

  // ChildError past the deadline, and where it ended.
  void write(std::string_view bytes, Clock::time_point deadline);
  // The next message; what is no message goes to the log.
  Message read(Clock::time_point deadline);
  // A message that is there without waiting.
  std::optional<Message> read_if_there();
  // Lets it end by itself until the deadline.
  void wait(Clock::time_point deadline);

  // Just before its last bytes were handed to it. Taken before, since it may answer before we run
  // again.
  Clock::time_point asked_at() const { return asked_at_; }
  const std::string& log() const { return log_; }

 private:
  void accept(Clock::time_point deadline);
  void pump(Clock::time_point deadline, std::string_view* unsent);
  bool drain(int& file, bool is_protocol);
  void take_lines();
  std::optional<Message> message_from_lines();
  void keep(std::string_view text);
  [[noreturn]] void fail(const std::string& what);
  std::string ending();
  bool ended();
  void close_all();

  std::stop_token stop_;
  pid_t process_ = -1;
  std::optional<Unfinished> unfinished_;  // its process group is ended
  std::optional<int> status_;
  int listening_ = -1;
  int to_ = -1;
  int from_ = -1;     // protocol
  int chatter_ = -1;  // standard error; with a socket, standard output too
  std::string input_;
  std::size_t searched_ = 0;  // of input_, for a line's end
  std::size_t parsed_ = 0;    // of input_, lines taken
  bool skips_line_ = false;   // a chatter line that was too long to hold
  Clock::time_point asked_at_;
  std::string log_;
};

}  // namespace airtruth::trax
