// SPDX-License-Identifier: Apache-2.0
#include "cli/console.h"

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <string_view>
#include <thread>

#include <fcntl.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <pthread.h>
#include <unistd.h>

#include "foundation/base/error.h"
#include "foundation/base/text.h"
#include "foundation/base/unfinished.h"

namespace airtruth::cli {
namespace {

using Clock = std::chrono::steady_clock;
// Intervals of progress: on a terminal, and in a log of JSON lines.
constexpr auto kRedraw = std::chrono::milliseconds(200);
constexpr auto kJsonEvery = std::chrono::seconds(2);

double seconds(Clock::duration duration) { return std::chrono::duration<double>(duration).count(); }

std::string time_left(double left_s) {
  const auto whole = static_cast<std::int64_t>(left_s + 0.5);
  return whole < 60 ? fmt::format("{} s", whole)
                    : fmt::format("{}:{:02} min", whole / 60, whole % 60);
}

// A message may quote any byte of a file or a name. No control sequence reaches the terminal.
std::string without_controls(std::string text, char line_end) {
  for (char& c : text)
    if (is_control(c)) c = c == '\n' ? line_end : '?';
  return text;
}

// A failure to write to standard error cannot be reported anywhere.
void to_standard_error(const std::string& text) {
  std::fwrite(text.data(), 1, text.size(), stderr);
  std::fflush(stderr);
}

std::string log_line(const char* level, const std::string& message, bool json) {
  if (!json) return fmt::format("airtruth: {}: {}\n", level, without_controls(message, ' '));
  const nlohmann::ordered_json line = {{"level", level}, {"message", message}};
  return line.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

// An interrupt is reported once: by the main thread, or by the thread that ends the process.
std::atomic<bool> interrupt_reported{false};
std::atomic<bool> interrupt_as_json{false};
constexpr const char* kInterruptedWords = "interrupted; no half-written file is left behind";

// A terminal without control sequences, as that of an editor or of a build service, says so.
bool has_terminal() {
  const char* kind = std::getenv("TERM");
  return ::isatty(STDERR_FILENO) == 1 && (kind == nullptr || kind != std::string_view("dumb"));
}

}  // namespace

Console::Console(const ConsoleOptions& options) : options_(options), terminal_(has_terminal()) {
  interrupt_as_json = options.json_log;
}

void Console::progress(const std::string& stage,
                       std::int64_t done,
                       std::int64_t total,
                       const std::string& unit) {
  if (options_.quiet || (!terminal_ && !options_.json_log)) return;
  const auto now = Clock::now();
  if (stage != stage_ || done <= 1) {
    stage_ = stage;
    start_ = last_ = now;
    return;
  }
  if (now - last_ < (options_.json_log ? Clock::duration(kJsonEvery) : Clock::duration(kRedraw)) &&
      done != total)
    return;
  last_ = now;
  const double rate = static_cast<double>(done - 1) / std::max(1e-9, seconds(now - start_));
  if (options_.json_log) {
    nlohmann::ordered_json line = {
        {"level", "progress"}, {"stage", stage}, {"done", done}, {"total", total}, {"per_s", rate}};
    to_standard_error(line.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
    return;
  }
  std::string text =
      total > 0
          ? fmt::format(
                "{}  {}/{} ({:.0f} %)", stage, done, total, 100.0 * double(done) / double(total))
          : fmt::format("{}  {}", stage, done);
  text += fmt::format("  {:.1f} {}/s", rate, unit);
  if (total > done && rate > 0)
    text += fmt::format("  {} left", time_left(static_cast<double>(total - done) / rate));
  to_standard_error("\r\x1b[K" + text);
  line_open_ = true;
}

void Console::end_progress() {
  if (line_open_) to_standard_error("\r\x1b[K");
  line_open_ = false;
}

void Console::log(const char* level, const std::string& message) {
  end_progress();
  to_standard_error(log_line(level, message, options_.json_log));
}

void Console::warning(const std::string& message) { log("warning", message); }
void Console::error(const std::string& message) { log("error", message); }
void Console::interrupted() {
  if (!interrupt_reported.exchange(true)) error(kInterruptedWords);
}
void Console::ended(const std::string& words) {
  if (!interrupt_reported.exchange(true)) result(words);
}

void Console::result(const std::string& message) {
  end_progress();
  if (!options_.quiet) print(without_controls(message, '\n') + "\n");
}

void Console::print(const std::string& text) {
  if (reader_left_) return;
  errno = 0;
  const bool whole = std::fwrite(text.data(), 1, text.size(), stdout) == text.size();
  if (whole && std::fflush(stdout) == 0) return;
  if (errno != EPIPE)
    throw Error(std::string("cannot write to standard output: ") + std::strerror(errno));
  reader_left_ = true;
}

void open_standard_streams() {
  for (const int file : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (::fcntl(file, F_GETFD) < 0 && errno == EBADF)
      // The lowest number that is free: this one.
      ::open("/dev/null", file == STDIN_FILENO ? O_RDONLY : O_WRONLY);
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);  // a write beyond `ulimit -f` fails, and is said
}

namespace {

// Work that checks the stop token ends by itself, and its destructors remove unfinished output.
// Other work is ended here. The time allowed is less than the two seconds that a stop may take.
constexpr timespec kGrace{.tv_sec = 1, .tv_nsec = 300'000'000};

[[noreturn]] void end_now() {
  undo_unfinished();
  if (!interrupt_reported.exchange(true)) {
    const std::string line = log_line("error", kInterruptedWords, interrupt_as_json);
    // stdio is not used, because another thread may hold its lock indefinitely.
    if (::write(STDERR_FILENO, line.data(), line.size()) < 0) std::_Exit(kInterrupted);
  }
  std::_Exit(kInterrupted);
}

// Waits for the signals. It is known before pass_on() is set as a handler.
pthread_t waiting_thread;

// Libraries may start threads before main(), as OpenBLAS does. They do not block the signals, and
// the kernel may choose one of them.
void pass_on(int which) {
  const int before = errno;
  pthread_kill(waiting_thread, which);
  errno = before;
}

}  // namespace

StopOnSignal::StopOnSignal() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  struct sigaction hang_up {};
  ::sigaction(SIGHUP, nullptr, &hang_up);
  if (hang_up.sa_handler != SIG_IGN) sigaddset(&signals, SIGHUP);  // nohup ignores it
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  std::thread waiting([signals, source = source_]() mutable {
    int which = 0;
    sigwait(&signals, &which);
    source.request_stop();
    sigtimedwait(&signals, nullptr, &kGrace);  // a second signal ends the wait
    end_now();
  });
  waiting_thread = waiting.native_handle();
  waiting.detach();
  struct sigaction passing {};
  passing.sa_handler = pass_on;
  passing.sa_flags = SA_RESTART;
  for (const int which : {SIGINT, SIGTERM, SIGHUP})
    if (sigismember(&signals, which) == 1) ::sigaction(which, &passing, nullptr);
}

}  // namespace airtruth::cli
