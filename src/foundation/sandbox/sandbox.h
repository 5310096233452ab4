// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <filesystem>
#include <stop_token>
#include <string>
#include <vector>

#include <sys/types.h>

#include "foundation/base/descriptor.h"
#include "foundation/sandbox/messages.h"

// A program of ours that reads an untrusted file in a child process, which can only answer through
// its socket (docs/decisions/0013). This is the parent's side; the child's is child.h, what it may
// do is confine.h, and what both say to each other is messages.h.
//
//   sandbox::Process reader(kModelReader, stop);
//   reader.set_deadline(20, "is not read within 20 s");
//   reader.send(Message::kJob, bytes_of(job));
//   const auto answer = reader.receive(kMaxAnswerBytes);
//   if (answer.closed) throw Error(sandbox::end_in_words(reader.end()));
namespace airtruth::sandbox {

struct Program {
  const char* name;      // airtruth-model-reader
  const char* variable;  // the environment variable that names another path
  const char* what;      // "the reader of 3D models", for messages
};

// The path of the program: the variable's value, else the first of its places
// (foundation/lazy_library). Throws Error where none of these exists.
std::filesystem::path path_of(const Program& program);

// The child and the parent's end of the socket. The destructor ends the child and waits for it. The
// child has the socket as standard input, no other open file, and no Ctrl-C from the terminal; its
// first argument is this process's number.
class Process : public Channel {
 public:
  // Throws Error where the program cannot be started.
  Process(const Program& program,
          std::stop_token stop,
          const std::vector<std::string>& arguments = {});
  ~Process() override { end(); }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  // From now on, receive() and send() throw Error{late} after this time and Interrupted within
  // 0.1 s of a requested stop.
  void set_deadline(double seconds, std::string late);

  // Ends the child and returns its status as waitpid reports it. A child that had ended by itself
  // keeps its own status.
  int end();

 protected:
  std::size_t read_some(char* data, std::size_t size) override;
  std::size_t write_some(const char* data, std::size_t size) override;

 private:
  template <typename Operation>
  std::size_t transfer(short event, const Operation& operation);

  std::stop_token stop_;
  std::chrono::steady_clock::time_point deadline_ = std::chrono::steady_clock::time_point::max();
  std::string late_;
  Descriptor socket_;
  pid_t process_ = -1;
};

// The end of a child as the second half of a message: "its reader ended with code 3", "its reader
// took too much time or memory and was ended", "its reader broke on it (Segmentation fault)".
std::string end_in_words(int status);

}  // namespace airtruth::sandbox
