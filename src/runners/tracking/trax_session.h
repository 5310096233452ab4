// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "foundation/base/files.h"
#include "foundation/geometry/box.h"
#include "foundation/image/picture.h"
#include "runners/process/child.h"
#include "runners/process/memory_place.h"
#include "runners/tracking/tracker.h"
#include "runners/tracking/trax_message.h"

namespace airtruth::tracking {

// How pictures reach a tracker: as a PNG's path; as samples in the message, "image:W;H;rgb;BASE64";
// or as a PNG's bytes in the message, "data:image/png;BASE64".
enum class ImageKind { kPath, kMemory, kBuffer };

// Pictures for one tracker. Files lie in memory (/dev/shm) where that exists. The last two files
// are kept.
class Images {
 public:
  explicit Images(ImageKind kind);
  Images(const Images&) = delete;
  Images& operator=(const Images&) = delete;

  // Returns the text by which a message refers to the picture.
  std::string hand_over(const image::Picture& picture);

 private:
  ImageKind kind_;
  std::optional<process::MemoryPlace> folder_;
  std::int64_t count_ = 0;
};

struct SessionOptions {
  std::string command;
  process::Child::Transport transport = process::Child::Transport::kStandard;
  double start_s = 30;  // time limit for its hello message
  double frame_s = 30;  // time limit for each answer
  std::stop_token stop;
};

// A tracker's description of itself.
struct Hello {
  std::string name;
  int version = 1;
  ImageKind images = ImageKind::kPath;  // the first kind that the tracker names
  bool takes_rectangles = true;         // false: polygons, or else masks
  bool takes_polygons = false;
  // True for a tracker with a "vot" property, which cannot be started twice.
  bool is_for_one_run = false;
};

// Throws process::Failure for an unknown version or an unknown kind of pictures.
Hello hello_of(const Message& message);

struct Reply {
  // Empty where the tracker reported no region, or a region without area.
  std::optional<Box> box;
  double confidence = 1;
  // Seconds from handing over the last bytes of the request to the answer.
  double seconds = 0;
};

// A session with a tracker over TraX, versions 1 to 4. Every function throws process::Failure once
// the tracker crashes, misses a deadline, quits, or violates the protocol. The session is then
// over.
class Session {
 public:
  explicit Session(const SessionOptions& options);
  ~Session();

  const Hello& hello() const { return hello_; }
  // Prepares the next picture; this time belongs to no request.
  void load(const image::Picture& picture);
  // Starts the tracker on the loaded picture. It may be called again where the tracker allows a
  // second start.
  Reply initialize(const Box& box);
  Reply frame();
  const std::string& log() const { return child_.log(); }

 private:
  Reply ask(const std::vector<Message>& requests);

  SessionOptions options_;
  process::Child child_;
  Hello hello_;
  std::unique_ptr<Images> images_;
  std::string image_;
  bool has_object_ = false;
};

// Makes a tracker that runs in its own process, from "trax:COMMAND" or "trax-socket:COMMAND";
// returns nullptr for any other name.
std::unique_ptr<Tracker> make_trax_tracker(std::string_view name, const TrackerOptions& options);

// Returns the name that the tracker reports, made valid as a file name; "trax" where it reports
// none.
std::string trax_name(std::string_view name, const TrackerOptions& options);

}  // namespace airtruth::tracking
