// SPDX-License-Identifier: Apache-2.0
#include "studio/session/job.h"

#include <utility>

#include <sys/resource.h>
#include <unistd.h>

namespace airtruth::session {
namespace {

// Threads that the work starts inherit it.
void step_back() {
  constexpr int kNice = 10;
  setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), kNice);
}

}  // namespace

void Job::start(std::function<void(const std::stop_token&)> work) {
  stop();
  thread_ = std::jthread([work = std::move(work)](const std::stop_token& token) {
    step_back();
    work(token);
  });
}

void Job::cancel() { thread_.request_stop(); }

void Job::stop() {
  if (!thread_.joinable()) return;
  thread_.request_stop();
  thread_.join();
}

}  // namespace airtruth::session
