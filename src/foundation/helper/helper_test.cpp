// SPDX-License-Identifier: Apache-2.0
#include <condition_variable>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "foundation/base/error.h"
#include "foundation/helper/confine.h"
#include "foundation/helper/helper_process.h"
#include "foundation/helper/late_library.h"
#include "foundation/helper/wire.h"

namespace airtruth::helper {
namespace {

// Each bit is something that a confined process managed to do.
int what_is_possible() {
  int possible = 0;
  if (::open("/etc/passwd", O_RDONLY) >= 0) possible |= 1;
  if (::open("/tmp/airtruth_confined", O_WRONLY | O_CREAT, 0600) >= 0) possible |= 2;
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

TEST(Wire, BytesThatEndEarlyAreRefused) {
  WireWriter out;
  out.put(1.5);
  out.put_text("words");
  const std::string bytes = out.take();
  WireReader in(bytes);
  EXPECT_EQ(in.get<double>(), 1.5);
  EXPECT_EQ(in.get_text(5), "words");
  EXPECT_NO_THROW(in.expect_end());
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    WireReader cut(std::string_view(bytes).substr(0, size));
    EXPECT_THROW(
        {
          cut.get<double>();
          cut.get_text(5);
        },
        Error);
  }
  WireReader longer(bytes);
  longer.get<double>();
  EXPECT_THROW(longer.get_text(4), Error);
}

TEST(Wire, AnErrorKeepsItsPlaceAndItsOneLine) {
  const Error error = error_from_bytes(bytes_of(Error("two\nlines", {"a.obj", 3})));
  EXPECT_EQ(std::string(error.what()), "a.obj:3: two?lines");
}

TEST(HelperProcess, AMissingProgramIsOneLine) {
  ::setenv("AIRTRUTH_NO_HELPER", "/nowhere/helper", 1);
  try {
    path_of({"no-helper", "AIRTRUTH_NO_HELPER", "the reader of nothing"});
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(std::string(error.what()),
              "/nowhere/helper: is what AIRTRUTH_NO_HELPER names, but no program");
  }
  ::unsetenv("AIRTRUTH_NO_HELPER");
  EXPECT_THROW(path_of({"no-helper", "AIRTRUTH_NO_HELPER", "the reader of nothing"}), Error);
}

TEST(HelperProcess, EndsInWords) {
  EXPECT_EQ(end_in_words(SIGSEGV), std::string("its reader broke on it (Segmentation fault)"));
  EXPECT_EQ(end_in_words(SIGKILL), "its reader took too much time or memory and was ended");
  EXPECT_EQ(end_in_words(3 << 8), "its reader ended with code 3");
}

std::string reason_of(const LateLibrary& library, const char* symbol) {
  try {
    symbol_of(library, symbol);
    return {};
  } catch (const Error& error) {
    return error.message();
  }
}

// The C library's mathematics stand for a library of ours, in the place that the variable names.
TEST(LateLibrary, GivesTheAddressOfASymbol) {
  const LateLibrary library{"no-such.so", "AIRTRUTH_TEST_LATE", "the tested part"};
  ::setenv("AIRTRUTH_TEST_LATE", "libm.so.6", 1);
  EXPECT_EQ(reinterpret_cast<double (*)(double)>(symbol_of(library, "fabs"))(-3), 3);
  EXPECT_THAT(reason_of(library, "no_such_function"), testing::HasSubstr("no_such_function"));
  ::unsetenv("AIRTRUTH_TEST_LATE");
}

TEST(LateLibrary, IsNamedWhereItIsNotThere) {
  EXPECT_THAT(reason_of({"no-such.so", "AIRTRUTH_TEST_LATE", "the tested part"}, "fabs"),
              testing::AllOf(testing::HasSubstr("no-such.so, the tested part, cannot be loaded"),
                             testing::HasSubstr("set AIRTRUTH_TEST_LATE to it")));
}

}  // namespace
}  // namespace airtruth::helper
