// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <fstream>
#include <string>
#include <thread>

#include <sys/types.h>

// For tests of programs in processes of their own.
namespace airtruth::test_support {

// Waits until a process that is no child of this one has ended; false after a minute, a limit that
// only stops a hang.
inline bool ends(pid_t process) {
  for (int i = 0; i < 6000; ++i) {
    std::string state;
    std::ifstream stat("/proc/" + std::to_string(process) + "/stat");
    if (!std::getline(stat, state) || state.find(") Z ") != std::string::npos) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return false;
}

}  // namespace airtruth::test_support
