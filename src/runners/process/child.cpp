// SPDX-License-Identifier: Apache-2.0
#include "runners/process/child.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <utility>
#include <vector>

#include <arpa/inet.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <poll.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

extern char** environ;

namespace airtruth::process {
namespace {

constexpr std::chrono::milliseconds kBetweenLooks{100};  // at the stop token
constexpr std::chrono::seconds kGrace{2};                // between SIGTERM and SIGKILL

[[noreturn]] void fail_system(const char* what) {
  throw Error(std::string("cannot ") + what + ": " + std::strerror(errno));
}

struct Pipe {
  Descriptor read;
  Descriptor write;
  Pipe() {
    std::array<int, 2> ends{};
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) fail_system("make a pipe");
    read.reset(ends[0]);
    write.reset(ends[1]);
  }
};

Descriptor unblocked(Descriptor& end) {
  ::fcntl(end.get(), F_SETFL, ::fcntl(end.get(), F_GETFL) | O_NONBLOCK);
  return std::move(end);
}

std::vector<std::string> environment(const std::string& added) {
  std::vector<std::string> all;
  for (char** one = ::environ; *one != nullptr; ++one)
    if (!std::string_view(*one).starts_with("TRAX_")) all.emplace_back(*one);
  if (!added.empty()) all.push_back(added);
  return all;
}

pid_t spawn(
    const std::string& command, int input, int output, int error, const std::string& added) {
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_adddup2(&files, input, 0);
  posix_spawn_file_actions_adddup2(&files, output, 1);
  posix_spawn_file_actions_adddup2(&files, error, 2);
  posix_spawn_file_actions_addclosefrom_np(&files, 3);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t none;
  sigset_t all;
  ::sigemptyset(&none);
  ::sigfillset(&all);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setsigdefault(&attributes, &all);
  posix_spawnattr_setpgroup(&attributes, 0);
  posix_spawnattr_setflags(&attributes,
                           POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
  std::vector<std::string> words = {"/bin/sh", "-c", command};
  std::vector<std::string> variables = environment(added);
  std::vector<char*> arguments;
  std::vector<char*> settings;
  for (std::string& word : words) arguments.push_back(word.data());
  for (std::string& variable : variables) settings.push_back(variable.data());
  arguments.push_back(nullptr);
  settings.push_back(nullptr);
  pid_t process = -1;
  const int failed =
      ::posix_spawn(&process, "/bin/sh", &files, &attributes, arguments.data(), settings.data());
  posix_spawn_file_actions_destroy(&files);
  posix_spawnattr_destroy(&attributes);
  if (failed != 0) {
    errno = failed;
    fail_system("start a process");
  }
  return process;
}

}  // namespace

Clock::time_point in(double seconds) {
  return Clock::now() +
         std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
}

Child::Child(const std::string& command,
             Transport transport,
             std::stop_token stop,
             std::string_view prefix)
    : stop_(std::move(stop)), prefix_(prefix) {
  // A write to a process that is gone is an error, not the end of ours. The program ignores the
  // signal from its start; tests and benchmarks do from here on.
  std::signal(SIGPIPE, SIG_IGN);
  Pipe to;
  Pipe from;
  Pipe chatter;
  if (transport == Transport::kStandard) {
    process_ = spawn(command, to.read.get(), from.write.get(), chatter.write.get(), "");
    to_ = unblocked(to.write);
    from_ = unblocked(from.read);
  } else {
    listening_.reset(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
    sockaddr_in place{};
    place.sin_family = AF_INET;
    place.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof place;
    auto* address = reinterpret_cast<sockaddr*>(&place);
    const int file = listening_.get();
    if (file < 0 || ::bind(file, address, size) != 0 || ::getsockname(file, address, &size) != 0 ||
        ::listen(file, 1) != 0)
      fail_system("listen on the loopback device");
    // Its input is at its end from the start.
    to.write.reset();
    process_ = spawn(command,
                     to.read.get(),
                     chatter.write.get(),
                     chatter.write.get(),
                     fmt::format("TRAX_SOCKET={}", ntohs(place.sin_port)));
  }
  chatter_ = unblocked(chatter.read);
  unfinished_.emplace([group = process_] { ::kill(-group, SIGKILL); });
}

Child::~Child() {
  ::kill(-process_, SIGTERM);
  try {
    stop_ = {};
    wait(Clock::now() + kGrace);
  } catch (const std::exception&) {  // it shall end, whatever it says meanwhile
  }
  // What it started may outlive it. The group's number is not given to another before the wait.
  ::kill(-process_, SIGKILL);
  unfinished_.reset();  // before the group's number is free for another
  int status = 0;
  while (::waitpid(process_, &status, 0) < 0 && errno == EINTR) {
  }
}

bool Child::ended() {
  if (status_) return true;
  siginfo_t info{};
  if (::waitid(P_PID, static_cast<id_t>(process_), &info, WEXITED | WNOHANG | WNOWAIT) != 0 ||
      info.si_pid == 0)
    return false;
  status_ = info.si_code == CLD_EXITED ? info.si_status : 128 + info.si_status;
  return true;
}

std::string Child::ending() {
  const auto until = Clock::now() + std::chrono::milliseconds(500);
  while (!ended() && Clock::now() < until) ::usleep(5000);
  drain(chatter_);
  std::string how = "closed its output";
  if (status_)
    how = *status_ > 128 ? fmt::format("was ended by signal {}", *status_ - 128)
                         : fmt::format("ended with status {}", *status_);
  std::string last = log_;
  while (!last.empty() && (last.back() == '\n' || last.back() == ' ')) last.pop_back();
  last = last.substr(last.rfind('\n') + 1).substr(0, 200);
  return last.empty() ? how : how + "; its last words: " + last;
}

void Child::keep(std::string_view text) {
  log_ += text.substr(0, kMaxLog - std::min(kMaxLog, log_.size()));
}

// Reads all that is there, and closes the file at its end.
void Child::drain(Descriptor& file) {
  std::array<char, 65536> bytes{};
  // Of one that never stops no more than this at a time, so that deadlines are looked at.
  for (int i = 0; i < 64; ++i) {
    const ssize_t count = ::read(file.get(), bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) return;
    if (count <= 0) return file.reset();
    const std::string_view text(bytes.data(), static_cast<std::size_t>(count));
    if (&file == &chatter_) {
      keep(text);
      continue;
    }
    input_ += text;
    take_lines();
  }
}

// Chatter goes to the log as it comes, however long its line.
void Child::take_lines() {
  std::size_t taken = 0;
  const auto begins_message = [&] {
    const std::string_view rest = std::string_view(input_).substr(taken);
    return std::string_view(prefix_).starts_with(rest.substr(0, prefix_.size()));
  };
  while (taken < input_.size()) {
    const std::size_t end = input_.find('\n', std::max(taken, searched_));
    searched_ = end == std::string::npos ? input_.size() : end;
    if (!skips_line_ && begins_message()) {
      if (end == std::string::npos && input_.size() - taken > kMaxBytes)
        throw Failure("sent a message of more than 64 MB");
      break;
    }
    const std::size_t stop = end == std::string::npos ? input_.size() : end + 1;
    keep(std::string_view(input_).substr(taken, stop - taken));
    skips_line_ = end == std::string::npos;
    taken = stop;
  }
  input_.erase(0, taken);
  searched_ -= std::min(searched_, taken);
}

std::optional<std::string> Child::line_from_input() {
  take_lines();
  const std::size_t end = input_.find('\n', searched_);
  if (end == std::string::npos) return std::nullopt;
  std::string line = input_.substr(0, end);
  input_.erase(0, end + 1);
  searched_ = 0;
  return line;
}

// Waits for something to read, or to write where there is something unsent, and does it.
void Child::pump(Clock::time_point deadline, std::string_view* unsent) {
  if (stop_.stop_requested()) throw Interrupted();
  const auto left =
      std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now()).count();
  if (left <= 0) throw Failure("did not answer in time");
  const bool writes = unsent != nullptr && !unsent->empty();
  std::array<pollfd, 3> files = {
      {{listening_.is_open() ? listening_.get() : from_.get(), POLLIN, 0},
       {chatter_.get(), POLLIN, 0},
       {writes ? to_.get() : -1, POLLOUT, 0}}};
  const auto most = std::min<std::int64_t>(left, kBetweenLooks.count());
  if (::poll(files.data(), files.size(), static_cast<int>(most)) <= 0) return;
  if (files[1].revents != 0) drain(chatter_);
  if (listening_.is_open()) return;
  if (files[0].revents != 0) drain(from_);
  if (files[2].revents != 0) {
    asked_at_ = Clock::now();
    const ssize_t count = ::write(to_.get(), unsent->data(), unsent->size());
    if (count > 0)
      unsent->remove_prefix(static_cast<std::size_t>(count));
    else if (errno != EAGAIN && errno != EINTR)
      throw Failure(ending());
  }
}

void Child::accept(Clock::time_point deadline) {
  while (listening_.is_open()) {
    Descriptor connected(
        ::accept4(listening_.get(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
    if (connected.is_open()) {
      listening_.reset();
      to_.reset(::fcntl(connected.get(), F_DUPFD_CLOEXEC, 0));
      if (!to_.is_open()) fail_system("keep a connection");
      from_ = std::move(connected);
      return;
    }
    if (ended()) throw Failure(ending());
    pump(deadline, nullptr);
  }
}

void Child::write(std::string_view bytes, Clock::time_point deadline) {
  accept(deadline);
  while (!bytes.empty()) {
    if (!to_.is_open()) throw Failure(ending());
    pump(deadline, &bytes);
  }
}

std::string Child::read(Clock::time_point deadline) {
  accept(deadline);
  while (true) {
    if (auto line = line_from_input()) return *line;
    if (!from_.is_open()) throw Failure(ending());
    pump(deadline, nullptr);
  }
}

std::optional<std::string> Child::read_if_there() {
  drain(from_);
  return line_from_input();
}

void Child::wait(Clock::time_point deadline) {
  while (!ended() && Clock::now() < deadline) {
    // Nobody reads it any more.
    input_.clear();
    searched_ = 0;
    if (from_.is_open() || chatter_.is_open())
      pump(std::min(deadline, Clock::now() + std::chrono::milliseconds(20)), nullptr);
    else
      ::usleep(2000);
  }
}

}  // namespace airtruth::process
