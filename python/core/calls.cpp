// SPDX-License-Identifier: Apache-2.0
#include "calls.h"

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <thread>
#include <utility>

#include <airtruth/error.h>
#include <pthread.h>
#include <unistd.h>

#include "values.h"

namespace airtruth::python {

Process::Process() : id_(::getpid()) {}
bool Process::is_this() const { return id_ == ::getpid(); }
void Process::expect_this(const char* what) const {
  if (!is_this())
    throw Error(std::string(what) + " was made before this process was forked; make it anew here");
}

namespace {

std::atomic<int> in_call = 0;     // threads that have released the GIL
std::atomic<int> taking_gil = 0;  // those of them that are about to have it again
std::atomic<bool> is_ending = false;
std::thread::id ending_thread;

// Threads that have asked for the GIL get it before the interpreter ends, and none asks later.
void end_of_interpreter() {
  ending_thread = std::this_thread::get_id();
  is_ending = true;
  PyThreadState* const thread = PyEval_SaveThread();
  while (taking_gil > 0) std::this_thread::yield();
  PyEval_RestoreThread(thread);
  // What is registered last is called first, before the destructors of static objects.
  on_exit(
      [](int status, void*) {
        if (in_call == 0) return;
        std::fflush(nullptr);
        _exit(status);
      },
      nullptr);
}

}  // namespace

GilReleased::GilReleased() : thread_(PyEval_SaveThread()) { ++in_call; }

GilReleased::~GilReleased() {
  ++taking_gil;
  if (is_ending && std::this_thread::get_id() != ending_thread) {
    --taking_gil;
    while (true) pause();
  }
  PyEval_RestoreThread(thread_);
  --taking_gil;
  --in_call;
}

void watch_end_of_interpreter() {
  // The other threads are not there after a fork.
  pthread_atfork(nullptr, nullptr, [] { taking_gil = in_call = 0; });
  py::module_::import("atexit").attr("register")(py::cpp_function(&end_of_interpreter));
}

int checked_threads(const py::object& threads, const char* what) {
  return whole_of<int>(threads, what, 0, 256);
}

Warn Warnings::taker() const {
  return [kept = kept_](const std::string& message) {
    const std::lock_guard lock(kept->mutex);
    kept->messages.push_back(message);
  };
}

void Warnings::hand_over() {
  std::vector<std::string> messages;
  {
    const std::lock_guard lock(kept_->mutex);
    messages.swap(kept_->messages);
  }
  // The second frame is that of whoever called the package.
  for (const std::string& message : messages)
    py::module_::import("warnings").attr("warn")(line_of_text(message), py::arg("stacklevel") = 2);
}

void HeardProgress::set(std::int64_t done, std::int64_t total) {
  const std::lock_guard lock(mutex_);
  news_ = {done, total};
}

void HeardProgress::tell() {
  std::unique_lock lock(mutex_);
  const auto news = std::exchange(news_, std::nullopt);
  lock.unlock();
  if (news && !heard_.is_none()) heard_(news->first, news->second);
}

namespace {

// The exception that a signal's handler or `look` raises.
std::optional<py::error_already_set> raised_by(const std::function<void()>& look) {
  try {
    if (PyErr_CheckSignals() != 0) return py::error_already_set();
    look();
  } catch (const py::error_already_set& error) {
    return error;
  }
  return std::nullopt;
}

}  // namespace

std::optional<py::error_already_set> await(
    const std::function<bool(std::chrono::milliseconds)>& wait,
    const std::function<bool()>& goes_on,
    const std::function<void()>& look) {
  constexpr std::chrono::milliseconds kLook{50};
  std::optional<py::error_already_set> raised;
  const auto is_over = [&] {
    const GilReleased released;
    return wait(kLook);
  };
  while (!is_over()) {
    if (raised) continue;
    raised = raised_by(look);
    if (raised && !goes_on()) return raised;
  }
  return raised;
}

Worker::Worker() : thread_([this] { loop(); }) {}

Worker::~Worker() {
  {
    const std::lock_guard lock(mutex_);
    is_over_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void Worker::loop() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [&] { return is_over_ || work_ != nullptr; });
    if (is_over_) return;
    lock.unlock();
    std::exception_ptr failure;
    try {
      (*work_)();
    } catch (...) {
      failure = std::current_exception();
    }
    lock.lock();
    failure_ = failure;
    work_ = nullptr;
    changed_.notify_all();
  }
}

void Worker::post(const std::function<void()>& work) {
  const std::lock_guard lock(mutex_);
  if (work_ != nullptr) throw Error("another thread is in a call of this object");
  work_ = &work;
  changed_.notify_all();
}

void Worker::run(const std::function<void()>& work, const std::function<void()>& look) {
  post(work);
  std::exception_ptr failure;
  const auto raised = await(
      [&](std::chrono::milliseconds most) {
        std::unique_lock lock(mutex_);
        const bool is_done = changed_.wait_for(lock, most, [&] { return work_ == nullptr; });
        if (is_done) failure = failure_;
        return is_done;
      },
      [&] {
        stop_.request_stop();
        return true;
      },
      look);
  if (raised) throw *raised;
  if (failure) std::rethrow_exception(failure);
}

void Worker::run_to_the_end(const std::function<void()>& work) {
  post(work);
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return work_ == nullptr; });
}

}  // namespace airtruth::python
