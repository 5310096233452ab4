// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <condition_variable>
#include <exception>
#include <filesystem>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <airtruth/error.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl/filesystem.h>
#include <sys/types.h>

// How calls of Python reach objects that hold threads, decoders and files.
namespace airtruth::python {

namespace py = pybind11;

// The process that made an object. A fork copies memory and no threads, so that what holds threads
// is of no use in the other process: neither to be called nor to be destroyed.
class Process {
 public:
  Process();
  bool is_this() const;
  // Throws Error in any other process.
  void expect_this(const char* what) const;

 private:
  pid_t id_;
};

// Releases the GIL for a scope, so that other threads of Python run meanwhile. A daemon thread that
// is in such a scope when the interpreter ends stays there: Python would end it, where it asks for
// the GIL again, by unwinding its stack, which C++ answers by ending the process. The process then
// ends without the destructors of static objects, which that thread may be using.
class GilReleased {
 public:
  GilReleased();
  ~GilReleased();
  GilReleased(const GilReleased&) = delete;
  GilReleased& operator=(const GilReleased&) = delete;

 private:
  PyThreadState* thread_;
};

// Has `atexit` call what GilReleased needs to know of the interpreter's end.
void watch_end_of_interpreter();

// 0 (one for each core) to 256; ValueError for any other. `what` names the argument.
int checked_threads(const py::object& threads, const char* what = "threads");

// Where measured motion is kept: True and False, or a folder. `Options` has use_cache and cache.
template <typename Options>
void take_cache(const py::object& cache, Options& options) {
  if (py::isinstance<py::bool_>(cache))
    options.use_cache = cache.cast<bool>();
  else
    options.cache = cache.cast<std::filesystem::path>();
}

// What the library warns of, kept until the caller's thread hands it to Python's `warnings`.
class Warnings {
 public:
  // Keeps messages of any thread, also of one that outlives this object.
  Warn taker() const;
  // With the GIL held. Throws where a filter of Python makes an error of a warning.
  void hand_over();

 private:
  struct Kept {
    std::mutex mutex;
    std::vector<std::string> messages;
  };
  std::shared_ptr<Kept> kept_ = std::make_shared<Kept>();
};

// Progress of work in another thread, which a function of Python hears of in its own.
class HeardProgress {
 public:
  explicit HeardProgress(py::object heard) : heard_(std::move(heard)) {}
  // From any thread.
  void set(std::int64_t done, std::int64_t total);
  // With the GIL held: calls the function where there is news.
  void tell();

 private:
  py::object heard_;
  std::mutex mutex_;
  std::optional<std::pair<std::int64_t, std::int64_t>> news_;
};

// Waits without the GIL until wait() returns true, which it returns false from where the given time
// passes before all is done. After each false it lets Python handle its signals and calls look(),
// with the GIL held. Where a handler (KeyboardInterrupt) or look() raises, the exception is
// returned: at once, or, where goes_on() says so, when all is done.
std::optional<py::error_already_set> await(
    const std::function<bool(std::chrono::milliseconds)>& wait,
    const std::function<bool()>& goes_on,
    const std::function<void()>& look);

// The result of a long computation that cannot be stopped. An exception of a signal's handler
// leaves it to end by itself, so that `work` must own what it uses.
template <typename Work>
auto left_alone(Work work) {
  std::packaged_task<decltype(work())()> task(std::move(work));
  auto result = task.get_future();
  std::thread(std::move(task)).detach();
  const auto raised = await(
      [&](std::chrono::milliseconds most) {
        return result.wait_for(most) == std::future_status::ready;
      },
      [] { return false; },
      [] {});
  if (raised) throw *raised;
  return result.get();
}

// A thread that runs the calls of one object, one after the other. An exception of a signal's
// handler requests the stop, waits for the call to end, and is thrown.
class Worker {
 public:
  Worker();
  ~Worker();

  std::stop_token stop() const { return stop_.get_token(); }
  bool is_stopped() const { return stop_.stop_requested(); }
  // With the GIL held. Rethrows what `work` throws. Throws Error where a call is under way already.
  // `look` as of await().
  void run(
      const std::function<void()>& work, const std::function<void()>& look = [] {});
  // The same without a look at signals, for the end of the object.
  void run_to_the_end(const std::function<void()>& work);

 private:
  void loop();
  void post(const std::function<void()>& work);

  std::stop_source stop_;
  std::mutex mutex_;
  std::condition_variable changed_;
  const std::function<void()>* work_ = nullptr;
  std::exception_ptr failure_;
  bool is_over_ = false;
  std::thread thread_;
};

// The result of one long call, work(options), which an exception of a signal's handler or of
// `progress`, a function of Python, stops. `Options` has stop, and may have warn and progress.
template <typename Options, typename Work>
auto stoppable(Options options, const Work& work, const py::object& progress = py::none()) {
  Warnings warnings;
  HeardProgress heard(progress);
  Worker worker;
  if constexpr (requires { options.warn; }) options.warn = warnings.taker();
  if constexpr (requires { options.progress; })
    options.progress = [&heard](std::int64_t done, std::int64_t total) { heard.set(done, total); };
  options.stop = worker.stop();
  std::optional<decltype(work(options))> result;
  worker.run([&] { result.emplace(work(options)); }, [&] { heard.tell(); });
  heard.tell();
  warnings.hand_over();
  return std::move(*result);
}

}  // namespace airtruth::python
