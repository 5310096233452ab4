// SPDX-License-Identifier: Apache-2.0
#include "runners/tracking/trax_tracker.h"

#include "foundation/base/error.h"
#include "runners/results/results_folder.h"
#include "runners/tracking/trax_session.h"

namespace airtruth::tracking {
namespace {

constexpr std::string_view kStandard = "trax:";
constexpr std::string_view kSocket = "trax-socket:";

SessionOptions session_options(std::string_view name, const TrackerOptions& options) {
  SessionOptions result;
  const bool is_socket = name.starts_with(kSocket);
  result.command = std::string(name.substr((is_socket ? kSocket : kStandard).size()));
  if (result.command.find_first_not_of(' ') == std::string::npos)
    throw Error("'" + std::string(name) + "' names no command");
  result.transport =
      is_socket ? process::Child::Transport::kSocket : process::Child::Transport::kStandard;
  result.start_s = options.start_s;
  result.frame_s = options.answer_s;
  result.stop = options.stop;
  return result;
}

class TraxTracker : public Tracker {
 public:
  explicit TraxTracker(SessionOptions options)
      : options_(std::move(options)), session_(std::make_unique<Session>(options_)) {}

  void load(const image::Picture& picture) override {
    picture_ = &picture;
    if (session_) session_->load(picture);
  }

  void init(const Box& box) override {
    guarded([&] {
      if (session_ && is_begun_ && session_->hello().is_for_one_run) end();
      if (!session_) {
        session_ = std::make_unique<Session>(options_);
        session_->load(*picture_);
      }
      is_begun_ = true;
      session_->initialize(box);
      last_ = box;
    });
  }

  Answer update() override {
    Answer answer;
    guarded([&] {
      check(session_ != nullptr, "a tracker is begun before it goes on");
      const Reply reply = session_->frame();
      answer.lost = !reply.box;
      if (reply.box) last_ = *reply.box;
      answer.box_px = last_;
      answer.confidence = reply.confidence;
      answer.seconds = reply.seconds;
    });
    return answer;
  }

  std::string log() const override { return log_ + (session_ ? session_->log() : ""); }

 private:
  void end() {
    log_ += session_->log();
    session_.reset();
  }

  void guarded(const auto& work) {
    try {
      work();
    } catch (const process::Failure&) {
      if (session_) end();
      throw;
    }
  }

  SessionOptions options_;
  std::unique_ptr<Session> session_;
  const image::Picture* picture_ = nullptr;
  bool is_begun_ = false;
  Box last_;
  std::string log_;
};

}  // namespace

std::unique_ptr<Tracker> make_trax_tracker(std::string_view name, const TrackerOptions& options) {
  if (!name.starts_with(kStandard) && !name.starts_with(kSocket)) return nullptr;
  return std::make_unique<TraxTracker>(session_options(name, options));
}

std::string trax_name(std::string_view name, const TrackerOptions& options) {
  std::string fit;
  const Session session(session_options(name, options));
  for (const char c : session.hello().name) fit += results::is_of_results_name(c) ? c : '_';
  while (!fit.empty() && fit.front() == '.') fit.erase(0, 1);
  return fit.empty() ? "trax" : fit.substr(0, 80);
}

}  // namespace airtruth::tracking
