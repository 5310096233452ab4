// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <stop_token>
#include <string>
#include <thread>

namespace airtruth::session {

// Something long that runs beside the pictures, behind them in its claim on the processor.
class Job {
 public:
  Job() = default;
  ~Job() { stop(); }
  Job(const Job&) = delete;
  Job& operator=(const Job&) = delete;

  // Ends what runs, and begins. `work` does not throw.
  void start(std::function<void(const std::stop_token&)> work);
  // Asks what runs to end, without waiting.
  void cancel();
  // Asks and waits.
  void stop();

 private:
  std::jthread thread_;
};

}  // namespace airtruth::session
