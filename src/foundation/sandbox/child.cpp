// SPDX-License-Identifier: Apache-2.0
#include "foundation/sandbox/child.h"

#include <cerrno>
#include <cstdlib>
#include <exception>
#include <new>
#include <string>

#include <signal.h>
#include <sys/prctl.h>
#include <unistd.h>

namespace airtruth::sandbox {
namespace {

// The bytes that the call moves; 0 where it fails. A signal lets it be made again.
template <typename Call>
std::size_t moved_by(const Call& call) {
  for (;;) {
    const ssize_t moved = call();
    if (moved >= 0) return static_cast<std::size_t>(moved);
    if (errno != EINTR) return 0;
  }
}

class ToParent : public Channel {
 protected:
  std::size_t read_some(char* data, std::size_t size) override {
    return moved_by([&] { return ::read(0, data, size); });
  }
  std::size_t write_some(const char* data, std::size_t size) override {
    return moved_by([&] { return ::write(0, data, size); });
  }
};

void end_with_parent(int parent) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(1);  // the parent ended before the call above
}

}  // namespace

int child_main(int argc,
               char** argv,
               int count,
               const std::function<void(Channel& parent, std::span<char*> arguments)>& work) {
  if (argc != 2 + count || ::isatty(0) != 0) {
    const std::string name = argc > 0 ? argv[0] : "this program";
    const std::string hint =
        name.substr(name.find_last_of('/') + 1) + " is started by airtruth alone\n";
    return ::write(2, hint.data(), hint.size()) < 0 ? 1 : 2;
  }
  end_with_parent(std::atoi(argv[1]));
  ToParent parent;
  try {
    work(parent, {argv + 2, static_cast<std::size_t>(count)});
  } catch (const std::exception&) {
    ::_exit(1);  // the parent reads the code
  }
  ::_exit(0);  // skips destructors, since sanitizers would open files at exit
}

bool told(Channel& parent, const Faults& faults, const std::function<void()>& work) {
  const auto failed = [&](const Error& error) {
    parent.send(faults.kind, bytes_of(error));
    return false;
  };
  try {
    work();
    return true;
  } catch (const Error& error) {
    return failed(error);
  } catch (const std::bad_alloc&) {
    return failed(Error(faults.no_memory));
  } catch (const std::exception& error) {
    return failed(Error(std::string(faults.other) + error.what()));
  }
}

}  // namespace airtruth::sandbox
