// SPDX-License-Identifier: Apache-2.0
#include "runners/tracking/trax_tracker.h"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/base/text.h"
#include "foundation/image/colour.h"
#include "foundation/run_files/memory_place.h"
#include "picture/video/still.h"
#include "runners/process/child.h"
#include "runners/results/results_folder.h"

namespace airtruth::tracking {
namespace {

constexpr int kNewest = 4;  // version of the protocol

// "path;memory", also with commas.
std::vector<std::string> list_of(std::string_view text) {
  std::string with_semicolons(text);
  std::ranges::replace(with_semicolons, ',', ';');
  std::vector<std::string> items = cells_of(with_semicolons, ';');
  std::erase(items, "");
  return items;
}

bool holds(const std::vector<std::string>& items, std::string_view item) {
  return std::find(items.begin(), items.end(), item) != items.end();
}

// Empty for what is not handed over here. The protocol's text says "data", its library "buffer".
std::optional<ImageKind> image_kind_of(std::string_view name) {
  if (name == "path") return ImageKind::kPath;
  if (name == "memory") return ImageKind::kMemory;
  if (name == "buffer" || name == "data") return ImageKind::kBuffer;
  return std::nullopt;
}

// Version 1 had other names for two of them.
std::string_view property(const Message& message, std::string_view name, std::string_view old) {
  const std::string_view value = message.property(name);
  return value.empty() ? message.property(old) : value;
}

void expect(const Message& message, Type type, const char* name) {
  if (message.type == Type::kQuit) {
    const std::string_view reason = message.property("trax.reason");
    throw process::Failure("quit" +
                           (reason.empty() ? "" : ": " + std::string(reason.substr(0, 200))));
  }
  if (message.type != type) throw process::Failure(std::string("sent no ") + name);
}

// Pictures for one tracker. Files lie in memory (/dev/shm) where that exists. The last two files
// are kept.
class Images {
 public:
  explicit Images(ImageKind kind) : kind_(kind) {
    if (kind_ != ImageKind::kMemory) folder_.emplace(PlaceKind::kFolder, "a tracker's pictures");
  }

  // Returns the text by which a message refers to the picture.
  std::string hand_over(const image::Picture& picture) {
    const image::Rgb8 rgb = image::rgb8_from_picture(picture);
    if (kind_ == ImageKind::kMemory)
      return fmt::format("image:{};{};rgb;{}", rgb.width, rgb.height, base64_of(rgb.bytes()));
    const auto path = [this](std::int64_t number) {
      return folder_->path() / fmt::format("{:08d}.png", number);
    };
    const fs::path file = path(count_);
    video::write_still(file, rgb, Flush::kLater);
    std::error_code ignored;
    if (count_ >= 2) fs::remove(path(count_ - 2), ignored);
    ++count_;
    if (kind_ == ImageKind::kPath) return "file://" + file.string();
    return "data:image/png;" + base64_of(read_file(file));
  }

 private:
  ImageKind kind_;
  std::optional<MemoryPlace> folder_;
  std::int64_t count_ = 0;
};

}  // namespace

Hello hello_of(const Message& message) {
  Hello hello;
  hello.name = std::string(message.property("trax.name"));
  if (const std::string_view version = message.property("trax.version"); !version.empty())
    hello.version = number_from_text<int>(version).value_or(-1);
  if (hello.version < 1 || hello.version > kNewest)
    throw process::Failure("speaks version '" +
                           std::string(message.property("trax.version").substr(0, 20)) +
                           "'; expected 1 to 4");
  const auto images = list_of(property(message, "trax.image", "trax.format.image"));
  if (!images.empty()) {
    const auto first = std::find_if(images.begin(), images.end(), [](const std::string& name) {
      return image_kind_of(name).has_value();
    });
    if (first == images.end())
      throw process::Failure("takes no pictures by path, memory or buffer");
    hello.images = *image_kind_of(*first);
  }
  const auto regions = list_of(property(message, "trax.region", "trax.format.region"));
  hello.takes_rectangles = regions.empty() || holds(regions, "rectangle");
  hello.takes_polygons = holds(regions, "polygon");
  if (!hello.takes_rectangles && !hello.takes_polygons && !holds(regions, "mask"))
    throw process::Failure("takes no rectangle, polygon or mask");
  for (const std::string& channel : list_of(message.property("trax.channels")))
    if (channel != "color")
      throw process::Failure("asks for the channel '" + channel.substr(0, 20) +
                             "'; a video has color alone");
  hello.is_for_one_run =
      std::any_of(message.properties.begin(), message.properties.end(), [](const auto& property) {
        return property.first == "vot" || property.first == "trax.vot";
      });
  return hello;
}

namespace {

constexpr std::string_view kStandard = "trax:";
constexpr std::string_view kSocket = "trax-socket:";

class TraxTracker : public Tracker {
 public:
  // Throws Error for a name without a command, and process::Failure as update() does.
  TraxTracker(std::string_view name, const TrackerOptions& options)
      : command_(name.substr(name.find(':') + 1)),
        transport_(name.starts_with(kSocket) ? process::Child::Transport::kSocket
                                             : process::Child::Transport::kStandard),
        options_(options) {
    if (command_.find_first_not_of(' ') == std::string::npos)
      throw Error("'" + std::string(name) + "' names no command");
    start();
  }
  TraxTracker(const TraxTracker&) = delete;
  TraxTracker& operator=(const TraxTracker&) = delete;
  ~TraxTracker() override { end(); }

  const Hello& hello() const { return hello_; }

  void load(const image::Picture& picture) override {
    picture_ = &picture;
    if (!child_) return;
    guarded([&] {
      try {
        image_ = images_->hand_over(picture);
      } catch (const Error& error) {  // as of a tracker that removes the folder of its pictures
        throw process::Failure(std::string("cannot be given a picture: ") + error.what());
      }
    });
  }

  void init(const Box& box) override {
    guarded([&] {
      if (has_object_ && hello_.is_for_one_run) end();
      if (!child_) {
        start();
        load(*picture_);
      }
      check(!image_.empty(), "a picture is loaded");
      const std::string region = hello_.takes_rectangles ? rectangle_of(box)
                                 : hello_.takes_polygons ? polygon_of(box)
                                                         : mask_of(box);
      std::vector<Message> requests;
      if (hello_.version >= 4) {
        // An empty one lets go of the object that it has.
        if (has_object_) requests.push_back({Type::kInitialize, {}, {}});
        requests.push_back({Type::kInitialize, {region}, {}});
        requests.push_back({Type::kFrame, {image_}, {}});
      } else {
        requests.push_back({Type::kInitialize, {image_, region}, {}});
      }
      has_object_ = true;
      ask(requests);
      last_ = box;
    });
  }

  Answer update() override {
    Answer answer;
    guarded([&] {
      check(child_ != nullptr, "a tracker is begun before it goes on");
      answer = ask({{Type::kFrame, {image_}, {}}});
    });
    return answer;
  }

  std::string log() const override { return log_ + (child_ ? child_->log() : ""); }

 private:
  void start() {
    auto child = std::make_unique<process::Child>(command_, transport_, options_.stop, kPrefix);
    const Message first = *parse_line(child->read(process::in(options_.start_s)));
    expect(first, Type::kHello, "hello");
    hello_ = hello_of(first);
    images_.emplace(hello_.images);
    has_object_ = false;
    child_ = std::move(child);
  }

  void end() {
    if (!child_) return;
    log_ += child_->log();
    try {
      child_->write(line_of({Type::kQuit, {}, {}}), process::in(0.5));
      child_->wait(process::in(1));
    } catch (const std::exception&) {  // it is ended with its process
    }
    images_.reset();
    child_.reset();
  }

  Answer ask(const std::vector<Message>& requests) {
    if (child_->read_if_there()) throw process::Failure("answered before it was asked");
    const auto deadline = process::in(options_.answer_s);
    for (const Message& request : requests) child_->write(line_of(request), deadline);
    const Message message = *parse_line(child_->read(deadline));
    const double took =
        std::chrono::duration<double>(process::Clock::now() - child_->asked_at()).count();
    expect(message, Type::kState, "state");
    if (message.arguments.size() != 1)
      throw process::Failure("sent a state with " + std::to_string(message.arguments.size()) +
                             " regions; expected one");
    const std::string& region = message.arguments.front();
    const std::optional<Box> box = box_of(region);
    if (box) last_ = *box;
    return {.box_px = last_,
            .lost = !box,
            .seconds = took,
            .has_negative_side = !box && has_negative_side(region)};
  }

  void guarded(const auto& work) {
    try {
      work();
    } catch (const process::Failure&) {
      end();
      throw;
    }
  }

  std::string command_;
  process::Child::Transport transport_;
  TrackerOptions options_;
  std::unique_ptr<process::Child> child_;  // null: it is over, and may be started again
  Hello hello_;
  std::optional<Images> images_;
  const image::Picture* picture_ = nullptr;
  std::string image_;        // how a message refers to the loaded picture
  bool has_object_ = false;  // the child was begun on one
  Box last_;
  std::string log_;  // of the children before
};

}  // namespace

std::unique_ptr<Tracker> make_trax_tracker(std::string_view name, const TrackerOptions& options) {
  if (!name.starts_with(kStandard) && !name.starts_with(kSocket)) return nullptr;
  return std::make_unique<TraxTracker>(name, options);
}

std::string trax_name(std::string_view name, const TrackerOptions& options) {
  std::string fit;
  const TraxTracker tracker(name, options);
  for (const char c : tracker.hello().name) fit += results::is_of_results_name(c) ? c : '_';
  while (!fit.empty() && fit.front() == '.') fit.erase(0, 1);
  return fit.empty() ? "trax" : fit.substr(0, 80);
}

}  // namespace airtruth::tracking
