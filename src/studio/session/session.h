// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "sequence/pipeline/options.h"
#include "studio/document/document.h"

// What a page can do with one scene: the document, and the pictures and paths that it stands for.
namespace airtruth::session {

// One page that is open.
using Client = std::uint64_t;

struct Options {
  // Of the rendering; warn, progress and stop are the session's own.
  pipeline::Options pipeline;
  // The folder of rendered videos.
  std::filesystem::path out;
};

// How answers reach the pages. `post` may be called by any thread, and runs a function on the
// thread of the session's owner; the others are called there alone.
struct Ways {
  std::function<void(std::function<void()>)> post;
  std::function<void(Client, std::string json)> send;
  std::function<void(Client, std::string bytes)> send_binary;
  std::function<void(const std::string& json)> send_all;
};

// Its functions belong to one thread, which they never hold up: pictures are drawn, and the clip is
// measured, by threads of the session.
class Session {
 public:
  Session(std::unique_ptr<document::Document> document, Options options, Ways ways);
  ~Session();

  // A message of a page (request.h), answered by `ways` now or later. Never throws.
  void take(Client client, const std::string& message);
  void leave(Client client);
  // To be called a few times a second: looks for changes of the file, and keeps the journal on the
  // disk.
  void tick();

  // Calls `done` with a JPEG, or with nothing where there is none of that name.
  using Done = std::function<void(std::optional<std::string> jpeg)>;
  void thumbnail(std::int64_t frame, int width, Done done);
  void aircraft_picture(const std::string& name, Done done);
  // The clip's video, and the one that was rendered last; empty where there is none.
  std::optional<std::filesystem::path> original_film() const;
  std::optional<std::filesystem::path> rendered_film() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace airtruth::session
