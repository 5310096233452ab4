// SPDX-License-Identifier: Apache-2.0
#include "aircraft/confined/child.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <stop_token>
#include <string>
#include <vector>

#include <dlfcn.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "aircraft/ac3d/ac_file.h"
#include "aircraft/confined/channel.h"
#include "aircraft/confined/model_wire.h"
#include "foundation/base/error.h"

extern "C" char** environ;

namespace airtruth::aircraft {
namespace {

using Clock = std::chrono::steady_clock;

constexpr const char* kReaderName = "airtruth-model-reader";
constexpr int kPollMs = 50;       // the interval at which a stop request is noticed
constexpr int kLowestOwnFd = 10;  // above the standard streams, which may be closed
constexpr std::size_t kMaxQuestionBytes = 65536;
constexpr std::size_t kMaxQuestions = 200'000;
constexpr std::size_t kMaxSentBytes = std::size_t{1} << 30;  // of all files together
constexpr std::size_t kMaxHandedBackBytes =
    32 * kMaxCorners + 16 * kMaxTriangles + 4 * kMaxPixels + (std::size_t{64} << 20);

class Descriptor {
 public:
  explicit Descriptor(int fd = -1) : fd_(fd) {}
  ~Descriptor() { reset(); }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int get() const { return fd_; }
  void reset(int fd = -1) {
    if (fd_ >= 0) ::close(fd_);
    fd_ = fd;
  }

 private:
  int fd_;
};

[[noreturn]] void fail_to_start(int error) {
  throw Error(std::string("the reader of 3D models cannot be started: ") + std::strerror(error));
}

// Moves a descriptor away from 0, 1 and 2, which the child's end of the socket is copied to.
int moved_up(int fd) {
  const int moved = ::fcntl(fd, F_DUPFD_CLOEXEC, kLowestOwnFd);
  const int error = errno;
  ::close(fd);
  if (moved < 0) fail_to_start(error);
  return moved;
}

// Sets up the child: the socket as standard input, no other open file, and no Ctrl-C from the
// terminal.
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

// The child and the parent's end of the socket. The destructor ends the child and waits for it.
class Reader : public Channel {
 public:
  explicit Reader(std::stop_token stop) : stop_(std::move(stop)) {
    std::array<int, 2> sockets{};
    if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, sockets.data()) != 0)
      fail_to_start(errno);
    Descriptor theirs;
    try {
      socket_.reset(moved_up(sockets[0]));
    } catch (...) {
      ::close(sockets[1]);
      throw;
    }
    theirs.reset(moved_up(sockets[1]));
    const std::string program = model_reader_program().string();
    const std::string parent = std::to_string(::getpid());
    std::array<char*, 3> arguments{
        const_cast<char*>(kReaderName), const_cast<char*>(parent.c_str()), nullptr};
    const SpawnSetup setup(theirs.get());
    const int failed = ::posix_spawn(
        &process_, program.c_str(), setup.actions(), setup.attributes(), arguments.data(), environ);
    if (failed != 0) {
      process_ = -1;
      throw Error(
          std::string("the reader of 3D models cannot be started: ") + std::strerror(failed),
          {program});
    }
  }
  ~Reader() override { end(); }
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;

  // Ends the child and returns its status as waitpid reports it. A child that had ended by itself
  // keeps its own status.
  int end() {
    if (process_ < 0) return 0;
    socket_.reset();
    ::kill(process_, SIGKILL);
    int status = 0;
    while (::waitpid(process_, &status, 0) < 0 && errno == EINTR) {
    }
    process_ = -1;
    return status;
  }

 protected:
  std::size_t read_some(char* data, std::size_t size) override {
    return transfer(POLLIN, [&] { return ::recv(socket_.get(), data, size, MSG_DONTWAIT); });
  }
  std::size_t write_some(const char* data, std::size_t size) override {
    return transfer(POLLOUT,
                    [&] { return ::send(socket_.get(), data, size, MSG_DONTWAIT | MSG_NOSIGNAL); });
  }

 private:
  template <typename Operation>
  std::size_t transfer(short event, const Operation& operation) {
    for (;;) {
      if (stop_.stop_requested()) throw Interrupted();
      if (Clock::now() > deadline_)
        throw Error("is not read within " + std::to_string(static_cast<int>(kReaderSeconds)) +
                    " s; a model that is whole takes a fraction of that");
      pollfd wanted{socket_.get(), event, 0};
      const int ready = ::poll(&wanted, 1, kPollMs);
      if (ready <= 0) continue;  // a timeout or a signal: check for a stop again
      const auto done = operation();
      if (done >= 0) return static_cast<std::size_t>(done);
      if (errno != EAGAIN && errno != EINTR) return 0;
    }
  }

  std::stop_token stop_;
  Clock::time_point deadline_ = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                                   std::chrono::duration<double>(kReaderSeconds));
  Descriptor socket_;
  pid_t process_ = -1;
};

std::string end_in_words(int status) {
  if (!WIFSIGNALED(status))
    return "cannot be read as a 3D model: its reader ended with code " +
           std::to_string(WEXITSTATUS(status));
  const int signal = WTERMSIG(status);
  if (signal == SIGXCPU || signal == SIGKILL)
    return "cannot be read as a 3D model: its reader took too much time or memory and was ended";
  return std::string("cannot be read as a 3D model: its reader broke on it (") +
         ::strsignal(signal) + ")";
}

void answer_kind(Reader& reader, DiskFiles& files, const std::string& path) {
  const char kind = static_cast<char>(files.kind(path));
  reader.send(Message::kKind, std::string_view(&kind, 1));
}

void answer_file(Reader& reader, DiskFiles& files, std::string_view question, std::size_t& sent) {
  WireReader in(question);
  const auto limit = static_cast<std::size_t>(in.get<std::uint64_t>());
  const std::string path = in.get_text(kMaxQuestionBytes);
  try {
    if (sent >= kMaxSentBytes) throw Error("asks for more than 1 GiB of files");
    const std::string bytes = files.read(path, std::min(limit, kMaxSentBytes - sent));
    sent += bytes.size();
    reader.send(Message::kFile, bytes);
  } catch (const Error& error) {
    reader.send(Message::kError, bytes_of(error));
  }
}

RawModel serve(Reader& reader, DiskFiles& files) {
  std::size_t sent = 0;
  for (std::size_t questions = 0; questions < kMaxQuestions; ++questions) {
    const Channel::Received received = reader.receive(kMaxHandedBackBytes);
    if (received.closed) throw Error(end_in_words(reader.end()));
    switch (received.message) {
      case Message::kAskKind:
        answer_kind(reader, files, received.bytes.substr(0, kMaxQuestionBytes));
        break;
      case Message::kAskFile:
        answer_file(reader, files, received.bytes, sent);
        break;
      case Message::kModel:
        return model_from_bytes(received.bytes);
      case Message::kError:
        throw error_from_bytes(received.bytes);
      default:
        throw Error("makes its reader say what it should not");
    }
  }
  throw Error("asks for more than " + std::to_string(kMaxQuestions) + " files");
}

// The path of the helper where a shared library holds this code, in PREFIX/lib or, as on Debian, in
// PREFIX/lib/x86_64-linux-gnu. It is empty in a program, whose name need not be a path.
std::vector<fs::path> beside_library() {
  Dl_info info{};
  if (::dladdr(reinterpret_cast<const void*>(&model_reader_program), &info) == 0) return {};
  const fs::path library = info.dli_fname;
  if (!library.is_absolute()) return {};
  const fs::path folder = library.parent_path().lexically_normal();
  const fs::path place = fs::path("libexec") / "airtruth" / kReaderName;
  return {folder.parent_path() / place, folder.parent_path().parent_path() / place};
}

bool is_program(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored) && ::access(path.c_str(), X_OK) == 0;
}

}  // namespace

fs::path model_reader_program() {
  if (const char* stated = std::getenv("AIRTRUTH_MODEL_READER");
      stated != nullptr && *stated != '\0') {
    if (!is_program(stated))
      throw Error("is what AIRTRUTH_MODEL_READER names, but no program", {stated});
    return stated;
  }
  std::error_code ignored;
  const fs::path own = fs::read_symlink("/proc/self/exe", ignored).parent_path();
  std::vector<fs::path> candidates = beside_library();
  candidates.insert(candidates.begin(),
                    {own / kReaderName, own.parent_path() / "libexec" / "airtruth" / kReaderName});
  candidates.push_back(fs::path(AIRTRUTH_LIBEXEC_FOLDER) / kReaderName);
  for (const fs::path& candidate : candidates)
    if (is_program(candidate)) return candidate;
  throw Error(std::string("the program ") + kReaderName +
              ", which reads model files, is not installed; install airtruth whole, or set "
              "AIRTRUTH_MODEL_READER to it");
}

RawModel read_in_child(DiskFiles& files, const fs::path& file, const LoadOptions& options) {
  try {
    Reader reader(options.stop);
    const ReaderJob job{
        file.string(), files.shown_folder().string(), files.in_data_root().string(), options};
    reader.send(Message::kJob, bytes_of(job));
    return serve(reader, files);
  } catch (const Error& error) {
    if (!error.where().file.empty()) throw;
    throw Error(error.message(), {files.shown(file).string()});
  }
}

}  // namespace airtruth::aircraft
