// SPDX-License-Identifier: Apache-2.0
#include "foundation/sandbox/sandbox.h"

#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <string_view>
#include <utility>

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/lazy_library/lazy_library.h"

extern "C" char** environ;

namespace airtruth::sandbox {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kPollMs = 50;       // the interval at which a stop request is noticed
constexpr int kLowestOwnFd = 10;  // above the standard streams, which may be closed

[[noreturn]] void fail_to_start(const Program& program, int error, const fs::path& path = {}) {
  throw Error(std::string(program.what) + " cannot be started: " + std::strerror(error),
              {path.string()});
}

// Moves a descriptor away from 0, 1 and 2, which the child's end of the socket is copied to.
Descriptor moved_up(const Program& program, const Descriptor& from) {
  Descriptor moved(::fcntl(from.get(), F_DUPFD_CLOEXEC, kLowestOwnFd));
  if (!moved.is_open()) fail_to_start(program, errno);
  return moved;
}

class SpawnSetup {
 public:
  explicit SpawnSetup(int socket) {
    posix_spawn_file_actions_init(&actions_);
    posix_spawnattr_init(&attributes_);
    posix_spawn_file_actions_adddup2(&actions_, socket, 0);
    posix_spawn_file_actions_addopen(&actions_, 1, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_addopen(&actions_, 2, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_addclosefrom_np(&actions_, 3);
    sigset_t blocked;
    sigemptyset(&blocked);
    sigaddset(&blocked, SIGINT);
    sigset_t defaults;
    sigfillset(&defaults);
    posix_spawnattr_setsigmask(&attributes_, &blocked);
    posix_spawnattr_setsigdefault(&attributes_, &defaults);
    posix_spawnattr_setflags(&attributes_, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
  }
  ~SpawnSetup() {
    posix_spawn_file_actions_destroy(&actions_);
    posix_spawnattr_destroy(&attributes_);
  }
  SpawnSetup(const SpawnSetup&) = delete;
  SpawnSetup& operator=(const SpawnSetup&) = delete;
  const posix_spawn_file_actions_t* actions() const { return &actions_; }
  const posix_spawnattr_t* attributes() const { return &attributes_; }

 private:
  posix_spawn_file_actions_t actions_{};
  posix_spawnattr_t attributes_{};
};

// What a child needs of the environment: where its libraries lie, and the settings of the tools
// that a build may hold (sanitizers, coverage). Everything else stays with the parent.
std::vector<char*> childs_environment() {
  constexpr std::array<std::string_view, 7> kPassed = {"AIRTRUTH_",
                                                       "LD_LIBRARY_PATH=",
                                                       "ASAN_OPTIONS=",
                                                       "LSAN_OPTIONS=",
                                                       "UBSAN_OPTIONS=",
                                                       "TSAN_OPTIONS=",
                                                       "LLVM_PROFILE_FILE="};
  std::vector<char*> passed;
  for (char** variable = environ; variable != nullptr && *variable != nullptr; ++variable)
    for (const std::string_view name : kPassed)
      if (std::string_view(*variable).starts_with(name)) passed.push_back(*variable);
  passed.push_back(nullptr);
  return passed;
}

bool is_program(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored) && ::access(path.c_str(), X_OK) == 0;
}

}  // namespace

fs::path path_of(const Program& program) {
  if (const char* stated = std::getenv(program.variable); stated != nullptr && *stated != '\0') {
    if (!is_program(stated))
      throw Error(std::string("is what ") + program.variable + " names, but no program", {stated});
    return stated;
  }
  for (const fs::path& candidate : lazy_library::places_of(program.name))
    if (is_program(candidate)) return candidate;
  throw Error(std::string("the program ") + program.name + ", " + program.what +
              ", is not installed; install airtruth whole, or set " + program.variable + " to it");
}

Process::Process(const Program& program,
                 std::stop_token stop,
                 const std::vector<std::string>& arguments)
    : stop_(std::move(stop)) {
  std::array<int, 2> sockets{};
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, sockets.data()) != 0)
    fail_to_start(program, errno);
  Descriptor ours(sockets[0]);
  Descriptor theirs(sockets[1]);
  ours = moved_up(program, ours);
  theirs = moved_up(program, theirs);
  const std::string path = path_of(program).string();
  std::vector<std::string> words = {program.name, std::to_string(::getpid())};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  const SpawnSetup setup(theirs.get());
  const std::vector<char*> variables = childs_environment();
  const int failed = ::posix_spawn(&process_,
                                   path.c_str(),
                                   setup.actions(),
                                   setup.attributes(),
                                   pointers.data(),
                                   variables.data());
  if (failed != 0) {
    process_ = -1;
    fail_to_start(program, failed, path);
  }
  socket_ = std::move(ours);
}

void Process::set_deadline(double seconds, std::string late) {
  deadline_ = Clock::now() +
              std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
  late_ = std::move(late);
}

int Process::end() {
  if (process_ < 0) return 0;
  socket_.reset();
  ::kill(process_, SIGKILL);
  int status = 0;
  while (::waitpid(process_, &status, 0) < 0 && errno == EINTR) {
  }
  process_ = -1;
  return status;
}

template <typename Operation>
std::size_t Process::transfer(short event, const Operation& operation) {
  for (;;) {
    if (stop_.stop_requested()) throw Interrupted();
    if (Clock::now() > deadline_) throw Error(late_);
    pollfd wanted{socket_.get(), event, 0};
    const int ready = ::poll(&wanted, 1, kPollMs);
    if (ready <= 0) continue;  // a timeout or a signal: check for a stop again
    const auto done = operation();
    if (done >= 0) return static_cast<std::size_t>(done);
    if (errno != EAGAIN && errno != EINTR) return 0;
  }
}

std::size_t Process::read_some(char* data, std::size_t size) {
  return transfer(POLLIN, [&] { return ::recv(socket_.get(), data, size, MSG_DONTWAIT); });
}

std::size_t Process::write_some(const char* data, std::size_t size) {
  return transfer(POLLOUT,
                  [&] { return ::send(socket_.get(), data, size, MSG_DONTWAIT | MSG_NOSIGNAL); });
}

std::string end_in_words(int status) {
  if (!WIFSIGNALED(status))
    return "its reader ended with code " + std::to_string(WEXITSTATUS(status));
  const int signal = WTERMSIG(status);
  if (signal == SIGXCPU || signal == SIGKILL)
    return "its reader took too much time or memory and was ended";
  return std::string("its reader broke on it (") + ::strsignal(signal) + ")";
}

}  // namespace airtruth::sandbox
