// SPDX-License-Identifier: Apache-2.0
#include "studio/session/worker.h"

#include <algorithm>
#include <utility>

namespace airtruth::session {

Worker::Worker() : thread_([this] { run(); }) {}

void Worker::end() {
  {
    const std::lock_guard lock(mutex_);
    over_ = true;
    waiting_.clear();
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void Worker::add(Task task) {
  std::function<void()> dropped;
  {
    const std::lock_guard lock(mutex_);
    if (over_) return;
    const auto same = std::ranges::find_if(
        waiting_, [&](const Task& one) { return !one.name.empty() && one.name == task.name; });
    if (same != waiting_.end()) {
      dropped = std::move(same->dropped);
      waiting_.erase(same);
    } else if (waiting_.size() >= kMostWaiting) {
      dropped = std::move(task.dropped);
      task.run = nullptr;
    }
    if (task.run) waiting_.push_back(std::move(task));
  }
  changed_.notify_all();
  if (dropped) dropped();
}

bool Worker::is_wanted_for(Urgency urgency) const {
  const std::lock_guard lock(mutex_);
  return over_ ||
         std::ranges::any_of(waiting_, [&](const Task& task) { return task.urgency <= urgency; });
}

std::list<Worker::Task>::iterator Worker::next() {
  const auto now = std::chrono::steady_clock::now();
  auto first = waiting_.end();
  for (auto it = waiting_.begin(); it != waiting_.end(); ++it)
    if (it->due <= now && (first == waiting_.end() || it->urgency < first->urgency)) first = it;
  return first;
}

void Worker::run() {
  std::unique_lock lock(mutex_);
  while (!over_) {
    const auto first = next();
    if (first == waiting_.end()) {
      const auto soonest = std::ranges::min_element(waiting_, {}, &Task::due);
      if (soonest == waiting_.end())
        changed_.wait(lock);
      else
        changed_.wait_until(lock, std::chrono::steady_clock::time_point(soonest->due));
      continue;
    }
    const Task task = std::move(*first);
    waiting_.erase(first);
    lock.unlock();
    task.run();
    lock.lock();
  }
}

}  // namespace airtruth::session
