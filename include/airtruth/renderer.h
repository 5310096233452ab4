// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string_view>

#include <airtruth/error.h>
#include <airtruth/export.h>
#include <airtruth/lens.h>
#include <airtruth/picture.h>
#include <airtruth/truth.h>
#include <airtruth/video.h>

namespace airtruth {

struct RenderOptions {
  // Number of threads, and of frames that are made at the same time; 0: one for each core; at most
  // 256. Pictures and truth do not depend on it.
  int threads = 0;
  // True: the measured motion and calibration of a clip are kept in a folder and read from it.
  bool use_cache = true;
  // That folder; empty: the user's own ($XDG_CACHE_HOME/airtruth).
  std::filesystem::path cache;
  Warn warn;
  // Called after each frame; total is 0 where the number of frames is unknown.
  std::function<void(std::int64_t done, std::int64_t total)> progress;
  // next() throws Interrupted once a stop is requested.
  std::stop_token stop;
};

struct RenderedFrame {
  FramePicture picture;
  FrameTruth truth;

  bool operator==(const RenderedFrame&) const = default;
};

// Puts a scene's intruders into its video, frame by frame, in memory: the same pictures and truth
// that `airtruth render SCENE.toml` writes, before its codec. Nothing is written but the cache.
//
// Example: a scene over a clip of 322 frames (docs/formats/scene.md has the keys of a scene).
//   Renderer renderer("scene.toml");
//   while (const std::optional<RenderedFrame> frame = renderer.next())   // 322 times
//     learn_from(rgb_of(frame->picture), frame->truth.intruders);
//
// The constructor reads all inputs, and measures what must be known of the whole clip before its
// first frame; this decodes the clip where it is not in the cache. It throws Error for faults in
// the scene and the files that it names, with file and line. A Renderer belongs to one thread at a
// time; with the method chroma-key, to the thread that made it.
class AIRTRUTH_API Renderer {
 public:
  explicit Renderer(const std::filesystem::path& scene_file, const RenderOptions& options = {});
  // The same for the text of a scene. Relative paths in it are relative to `folder`, and messages
  // name folder/"scene".
  static Renderer from_text(std::string_view scene,
                            const std::filesystem::path& folder,
                            const RenderOptions& options = {});
  ~Renderer();
  Renderer(Renderer&&) noexcept;
  Renderer& operator=(Renderer&&) noexcept;

  // The next frame; empty after the last one. Throws Interrupted after a stop.
  std::optional<RenderedFrame> next();

  // The background, with the number of frames that the scene makes of it.
  VideoInfo info() const;
  Lens lens() const;

 private:
  struct State;
  explicit Renderer(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace airtruth
