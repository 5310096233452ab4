// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <functional>
#include <list>
#include <mutex>
#include <string>
#include <thread>
#include <utility>

namespace airtruth::session {

// One thread that does what is asked of it, the most urgent first.
class Worker {
 public:
  // What the page waits for, before what it would like to have.
  enum class Urgency { kFrame, kPlan, kLater };

  Worker();
  ~Worker() { end(); }
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  struct Task {
    Urgency urgency = Urgency::kFrame;
    // A task replaces the one with the same name that has not begun; "": it replaces none.
    std::string name;
    std::function<void()> run;      // does not throw
    std::function<void()> dropped;  // in its place, where it is replaced or there are too many
    // It begins no sooner.
    std::chrono::steady_clock::time_point due{};
  };
  void add(Task task);
  void add(Urgency urgency, std::function<void()> run, std::function<void()> dropped = {}) {
    add({urgency, "", std::move(run), std::move(dropped)});
  }
  // Drops what has not begun, waits for what has, and takes no more.
  void end();

  // For a task that takes long: true where one that is as urgent or more waits.
  bool is_wanted_for(Urgency urgency) const;

 private:
  // So many wait at most: more than a page asks for at a time.
  static constexpr std::size_t kMostWaiting = 256;

  void run();
  // The most urgent of those that are due; the end where there is none.
  std::list<Task>::iterator next();

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::list<Task> waiting_;
  bool over_ = false;
  std::thread thread_;
};

}  // namespace airtruth::session
