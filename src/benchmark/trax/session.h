// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "benchmark/trax/child.h"
#include "benchmark/trax/images.h"
#include "foundation/geometry/box.h"
#include "foundation/image/picture.h"

namespace airtruth::trax {

struct SessionOptions {
  std::string command;
  Child::Transport transport = Child::Transport::kStandard;
  double start_s = 30;  // for its hello
  double frame_s = 30;  // for each answer
  std::stop_token stop;
};

// What a tracker says of itself.
struct Hello {
  std::string name;
  int version = 1;
  ImageKind images = ImageKind::kPath;  // the first that it names
  bool takes_rectangles = true;         // else polygons, else masks
  bool takes_polygons = false;
  bool is_for_one_run = false;  // has a "vot" property: cannot be begun twice
};

// Throws ProtocolError for a version or a form of pictures that is not known here.
Hello hello_of(const Message& message);

struct Reply {
  std::optional<Box> box;  // empty: it said that it does not know, or nothing that has an area
  double confidence = 1;
  double seconds = 0;  // from handing over the last bytes of the request to its answer
};

// A tracker that is spoken to over TraX, versions 1 to 4. All of it throws ProtocolError (a
// ChildError where the process is at fault) once the tracker crashes, hangs past a deadline, quits,
// or says what the protocol does not allow; the session is then over.
class Session {
 public:
  explicit Session(const SessionOptions& options);
  ~Session();

  const Hello& hello() const { return hello_; }
  // Makes the next picture ready; of no request's time.
  void load(const image::Picture& picture);
  // Begins on the loaded picture, also a second time where the tracker can.
  Reply initialize(const Box& box);
  Reply frame();
  const std::string& log() const { return child_.log(); }

 private:
  Reply ask(const std::vector<Message>& requests);

  SessionOptions options_;
  Child child_;
  Hello hello_;
  std::unique_ptr<Images> images_;
  std::string image_;
  bool has_object_ = false;
};

}  // namespace airtruth::trax
