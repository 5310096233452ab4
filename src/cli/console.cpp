// SPDX-License-Identifier: Apache-2.0
#include "cli/console.h"

#include <cstdio>
#include <cstdlib>
#include <thread>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <pthread.h>
#include <signal.h>
#include <unistd.h>

namespace airtruth::cli {
namespace {

using Clock = std::chrono::steady_clock;
constexpr auto kRedraw = std::chrono::milliseconds(200);
constexpr auto kJsonEvery = std::chrono::seconds(2);

double seconds(Clock::duration duration) { return std::chrono::duration<double>(duration).count(); }

std::string time_left(double left_s) {
  const auto whole = static_cast<std::int64_t>(left_s + 0.5);
  return whole < 60 ? fmt::format("{} s", whole)
                    : fmt::format("{}:{:02} min", whole / 60, whole % 60);
}

}  // namespace

Console::Console(const ConsoleOptions& options)
    : options_(options), terminal_(::isatty(STDERR_FILENO) == 1) {}

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
    fmt::print(stderr, "{}\n", line.dump());
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
  fmt::print(stderr, "\r\x1b[K{}", text);
  std::fflush(stderr);
  line_open_ = true;
}

void Console::end_progress() {
  if (line_open_) fmt::print(stderr, "\r\x1b[K");
  std::fflush(stderr);
  line_open_ = false;
}

void Console::log(const char* level, const std::string& message) {
  end_progress();
  if (options_.json_log) {
    const nlohmann::ordered_json line = {{"level", level}, {"message", message}};
    fmt::print(stderr, "{}\n", line.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
  } else {
    fmt::print(stderr, "airtruth: {}: {}\n", level, message);
  }
}

void Console::warning(const std::string& message) { log("warning", message); }
void Console::error(const std::string& message) { log("error", message); }

void Console::result(const std::string& message) {
  end_progress();
  if (!options_.quiet) fmt::print("{}\n", message);
  std::fflush(stdout);
}

StopOnSignal::StopOnSignal() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  std::thread([signals, source = source_]() mutable {
    int which = 0;
    sigwait(&signals, &which);
    source.request_stop();
    sigwait(&signals, &which);
    std::_Exit(130);
  }).detach();
}

}  // namespace airtruth::cli
