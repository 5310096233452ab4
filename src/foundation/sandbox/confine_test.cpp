// SPDX-License-Identifier: Apache-2.0
#include "foundation/sandbox/confine.h"

#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

namespace airtruth::sandbox {
namespace {

// Each bit is something that a confined process managed to do.
int what_is_possible() {
  int possible = 0;
  if (::open("/etc/passwd", O_RDONLY) >= 0) possible |= 1;
  if (::open("airtruth_confined", O_WRONLY | O_CREAT, 0600) >= 0) possible |= 2;
  if (::socket(AF_INET, SOCK_STREAM, 0) >= 0) possible |= 4;
  if (::fork() >= 0) possible |= 8;
  ::execl("/bin/true", "true", nullptr);  // on success the code is 0, which no bit says
  if (::mmap(nullptr, 4096, PROT_READ | PROT_EXEC, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0) !=
      MAP_FAILED)
    possible |= 16;
  if (::kill(::getppid(), 0) == 0) possible |= 32;
  // What it needs is there: memory.
  void* const memory =
      ::mmap(nullptr, 1 << 20, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  return memory == MAP_FAILED ? 128 : possible | 64;
}

int code_of_child(const std::function<int()>& work) {
  const pid_t child = ::fork();
  if (child == 0) ::_exit(work());
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST(Confine, LeavesNothingButMemory) {
  EXPECT_EQ(code_of_child([] {
              confine({});
              return what_is_possible();
            }),
            64);
}

// A sanitizer begins and ends threads by calls that confinement refuses. So the thread is at work
// before it, and ends the process.
TEST(Confine, HoldsForAThreadThatIsThereAlready) {
  EXPECT_EQ(code_of_child([] {
              std::mutex mutex;
              std::condition_variable changed;
              bool begun = false;
              bool confined = false;
              std::thread worker([&] {
                std::unique_lock lock(mutex);
                begun = true;
                changed.notify_one();
                changed.wait(lock, [&] { return confined; });
                ::_exit(what_is_possible());
              });
              std::unique_lock lock(mutex);
              changed.wait(lock, [&] { return begun; });
              confine({});
              confined = true;
              lock.unlock();
              changed.notify_one();
              worker.join();
              return -1;
            }),
            64);
}

}  // namespace
}  // namespace airtruth::sandbox
