// SPDX-License-Identifier: Apache-2.0
#include "runners/tracking/trax_session.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <optional>

#include <fmt/format.h>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/base/text.h"
#include "foundation/image/colour.h"
#include "picture/video/still.h"
#include "runners/results/results_folder.h"

namespace airtruth::tracking {
namespace {

constexpr int kNewest = 4;  // version of the protocol

// "path;memory", also with commas.
std::vector<std::string> list_of(std::string_view text) {
  std::vector<std::string> items;
  std::string item;
  for (const char c : text) {
    if (c == ';' || c == ',') {
      items.push_back(std::move(item));
      item.clear();
    } else if (c != ' ') {
      item += c;
    }
  }
  items.push_back(std::move(item));
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

double confidence_of(const Message& message) {
  const std::string_view text = message.property("confidence");
  double value = 1;
  const auto [stop, fault] = std::from_chars(text.data(), text.data() + text.size(), value);
  return fault == std::errc() && std::isfinite(value) ? value : 1;
}

void expect(const Message& message, Type type, const char* name) {
  if (message.type == Type::kQuit) {
    const std::string_view reason = message.property("trax.reason");
    throw process::Failure("it quit" +
                           (reason.empty() ? "" : ": " + std::string(reason.substr(0, 200))));
  }
  if (message.type != type) throw process::Failure(std::string("it sent no ") + name);
}

Reply reply_of(const Message& message) {
  Reply reply;
  if (message.arguments.size() != 1)
    throw process::Failure("its state has " + std::to_string(message.arguments.size()) +
                           " regions; expected one");
  reply.box = box_of(message.arguments.front());
  reply.confidence = confidence_of(message);
  return reply;
}

}  // namespace

Images::Images(ImageKind kind) : kind_(kind) {
  if (kind_ != ImageKind::kMemory) folder_.emplace(PlaceKind::kFolder, "a tracker's pictures");
}

std::string Images::hand_over(const image::Picture& picture) {
  const image::Rgb8 rgb = image::rgb8_from_picture(picture);
  if (kind_ == ImageKind::kMemory) {
    const std::string_view samples(
        reinterpret_cast<const char*>(rgb.samples.get()),
        3 * static_cast<std::size_t>(rgb.width) * static_cast<std::size_t>(rgb.height));
    return fmt::format("image:{};{};rgb;{}", rgb.width, rgb.height, base64_of(samples));
  }
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

Hello hello_of(const Message& message) {
  Hello hello;
  hello.name = std::string(message.property("trax.name"));
  if (const std::string_view version = message.property("trax.version"); !version.empty())
    hello.version = number_from_text<int>(version).value_or(-1);
  if (hello.version < 1 || hello.version > kNewest)
    throw process::Failure("it speaks version '" +
                           std::string(message.property("trax.version").substr(0, 20)) +
                           "'; expected 1 to 4");
  const auto images = list_of(property(message, "trax.image", "trax.format.image"));
  if (!images.empty()) {
    const auto first = std::find_if(images.begin(), images.end(), [](const std::string& name) {
      return image_kind_of(name).has_value();
    });
    if (first == images.end())
      throw process::Failure("it takes no pictures by path, memory or buffer");
    hello.images = *image_kind_of(*first);
  }
  const auto regions = list_of(property(message, "trax.region", "trax.format.region"));
  hello.takes_rectangles = regions.empty() || holds(regions, "rectangle");
  hello.takes_polygons = holds(regions, "polygon");
  if (!hello.takes_rectangles && !hello.takes_polygons && !holds(regions, "mask"))
    throw process::Failure("it takes no rectangle, polygon or mask");
  for (const std::string& channel : list_of(message.property("trax.channels")))
    if (channel != "color")
      throw process::Failure("it asks for the channel '" + channel.substr(0, 20) +
                             "'; a video has color alone");
  hello.is_for_one_run =
      std::any_of(message.properties.begin(), message.properties.end(), [](const auto& property) {
        return property.first == "vot" || property.first == "trax.vot";
      });
  return hello;
}

Session::Session(const SessionOptions& options)
    : options_(options), child_(options.command, options.transport, options.stop, kPrefix) {
  const Message first = *parse_line(child_.read(process::in(options.start_s)));
  expect(first, Type::kHello, "hello");
  hello_ = hello_of(first);
  images_ = std::make_unique<Images>(hello_.images);
}

Session::~Session() {
  try {
    child_.write(line_of({Type::kQuit, {}, {}}), process::in(0.5));
    child_.wait(process::in(1));
  } catch (const std::exception&) {  // it is ended with its process
  }
}

void Session::load(const image::Picture& picture) { image_ = images_->hand_over(picture); }

Reply Session::ask(const std::vector<Message>& requests) {
  if (child_.read_if_there()) throw process::Failure("it answered before it was asked");
  const auto deadline = process::in(options_.frame_s);
  for (const Message& request : requests) child_.write(line_of(request), deadline);
  const Message message = *parse_line(child_.read(deadline));
  const double took =
      std::chrono::duration<double>(process::Clock::now() - child_.asked_at()).count();
  expect(message, Type::kState, "state");
  Reply reply = reply_of(message);
  reply.seconds = took;
  return reply;
}

Reply Session::initialize(const Box& box) {
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
  return ask(requests);
}

Reply Session::frame() { return ask({{Type::kFrame, {image_}, {}}}); }

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
