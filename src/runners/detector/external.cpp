// SPDX-License-Identifier: Apache-2.0
#include <cerrno>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>

#include <fcntl.h>
#include <unistd.h>

#include "foundation/base/error.h"
#include "foundation/image/colour.h"
#include "foundation/run_files/memory_place.h"
#include "runners/detector/detector.h"
#include "runners/detector/protocol.h"
#include "runners/process/child.h"

namespace airtruth::detector {
namespace {

// Its answers are the lines that begin as a JSON object does; all else that it prints is kept in a
// log.
constexpr std::string_view kAnswerBegins = "{";
constexpr double kQuitS = 0.5;  // to take the request to quit
constexpr double kEndS = 1;     // to end after it

// Rows of samples without padding: red, green and blue, or luma alone as the video has it.
std::string samples_of(const image::Picture& picture, SampleOrder samples) {
  if (samples == SampleOrder::kRgb) return std::string(image::rgb8_from_picture(picture).bytes());
  std::string bytes(pixels_in(picture.width, picture.height), '\0');
  auto* target = reinterpret_cast<std::uint8_t*>(bytes.data());
  for (int y = 0; y < picture.height; ++y, target += picture.width)
    image::copy_luma(picture, 0, y, picture.width, target);
  return bytes;
}

// A file in memory that a program at this machine can map. It is not mapped here: a program that
// shortens the file would end this process with SIGBUS.
class SharedSamples {
 public:
  // Throws Error where it cannot be made.
  explicit SharedSamples(std::size_t bytes) {
    // The blocks are taken now: a full disk is an error here.
    const int fault = ::posix_fallocate(place_.descriptor(), 0, static_cast<off_t>(bytes));
    if (fault != 0)
      throw Error(
          std::string("cannot take memory for a detector's frames: ") + std::strerror(fault),
          {path()});
  }

  std::string path() const { return place_.path().string(); }
  // The file is as long as the samples again, whatever the program has made of it.
  void write(std::string_view samples) {
    for (off_t at = 0; !samples.empty();) {
      const ssize_t put = ::pwrite(place_.descriptor(), samples.data(), samples.size(), at);
      if (put < 0 && errno == EINTR) continue;
      if (put < 0)
        throw process::Failure(std::string("has a file of frames that cannot be written: ") +
                               std::strerror(errno));
      at += put;
      samples.remove_prefix(static_cast<std::size_t>(put));
    }
  }

 private:
  MemoryPlace place_{PlaceKind::kFile, "a detector's frames"};
};

class External : public Detector {
 public:
  External(std::string command, const process::Limits& limits)
      : command_(std::move(command)), limits_(limits) {}
  External(const External&) = delete;
  External& operator=(const External&) = delete;
  ~External() override { end(); }

  void begin(const SequenceInput& sequence) override {
    end();
    log_.clear();
    guarded([&] {
      child_.emplace(command_, process::Child::Transport::kStandard, limits_.stop, kAnswerBegins);
      const auto deadline = process::in(limits_.start_s);
      hello_ = hello_of(child_->read(deadline));
      if (hello_.frames == FramesBy::kSharedMemory)
        shared_.emplace(pixels_in(sequence.width, sequence.height) *
                        static_cast<std::size_t>(hello_.bytes_per_pixel()));
      child_->write(begin_line(sequence, shared_ ? shared_->path() : ""), deadline);
    });
  }

  std::vector<results::Detection> detect(const FrameInput& frame) override {
    std::vector<results::Detection> detections;
    guarded([&] {
      check(child_.has_value(), "a sequence is begun before its frames");
      if (child_->read_if_there()) throw process::Failure("answered before it was asked");
      const std::string samples = samples_of(*frame.picture, hello_.samples);
      const auto deadline = process::in(limits_.answer_s);
      if (shared_) shared_->write(samples);
      child_->write(frame_line(frame, samples.size()), deadline);
      if (!shared_) child_->write(samples, deadline);
      detections = detections_of(child_->read(deadline), frame.index);
    });
    return detections;
  }

  bool needs_motion() const override { return true; }
  std::string log() const override { return log_ + (child_ ? child_->log() : ""); }

 private:
  void guarded(const auto& work) {
    try {
      work();
    } catch (const process::Failure&) {
      end();
      throw;
    }
  }

  void end() {
    if (!child_) return;
    try {
      child_->write(kQuitLine, process::in(kQuitS));
      child_->wait(process::in(kEndS));
    } catch (const std::exception&) {  // it is ended with its process
    }
    log_ += child_->log();
    child_.reset();
    shared_.reset();
  }

  std::string command_;
  process::Limits limits_;
  std::optional<SharedSamples> shared_;
  std::optional<process::Child> child_;
  Hello hello_;
  std::string log_;
};

}  // namespace

std::unique_ptr<Detector> make_external(std::string command, const process::Limits& limits) {
  return std::make_unique<External>(std::move(command), limits);
}

}  // namespace airtruth::detector
