// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include <airtruth/box.h>
#include <airtruth/error.h>
#include <airtruth/export.h>
#include <airtruth/picture.h>
#include <airtruth/renderer.h>
#include <airtruth/truth.h>

namespace airtruth {

struct StreamOptions {
  // With the catalogue it decides every sample; another seed gives other samples.
  std::uint64_t seed = 1;
  // Number of threads that draw one sample; 0: one for each core; at most 256. Samples do not
  // depend on it. Loaders that run several workers take 1.
  int threads = 1;
  // As in RenderOptions.
  bool use_cache = true;
  std::filesystem::path cache;
  // Each warning comes once, from any thread that makes a sample, one call at a time.
  Warn warn;
  // sample() throws Interrupted once a stop is requested.
  std::stop_token stop;
};

// One picture to learn from, or several in a row of one flight, with their truth.
struct StreamSample {
  std::int64_t index = 0;
  // Name of the background in the catalogue, and the number of the first picture's frame in its
  // video, from 0.
  std::string background;
  std::int64_t first_frame = 0;
  // How many encounters of real traffic the sample stands for, up to a factor that a stream shares;
  // empty where it is not drawn from a model of traffic.
  std::optional<double> weight;
  // The part of the background's frame that the pictures show, in its pixels. Its corner is even.
  PixelBox crop{};
  // As many as the catalogue's [stream] frames. The pictures show `crop`; the truth is that of the
  // whole frame, in the frame's pixels (in_crop() gives boxes in those of the crop).
  std::vector<RenderedFrame> frames;
  // With the catalogue's [stream] masks: for each frame, for each intruder of its truth, a plane of
  // the crop's size that holds 255 alpha of its pixels, as the masks of `airtruth render` do.
  std::vector<std::vector<SamplePlane>> masks;
  // For each frame, for each intruder of its truth: the bounds of what it covers of the crop, in
  // the crop's pixels, as covered_box_px bounds it in the frame; empty where it covers nothing
  // there. Where the crop cuts an intruder, they are tighter than in_crop() of its covered_box_px.
  std::vector<std::vector<std::optional<PixelBox>>> covered;

  bool operator==(const StreamSample&) const = default;
};

// The part of a box of the frame that lies in the crop, in the crop's pixels; empty where none
// does.
AIRTRUTH_API std::optional<Box> in_crop(const Box& box_px, const PixelBox& crop);

// An endless series of labelled pictures of a catalogue, made when they are asked for: nothing is
// written but the cache. The catalogue is the one that data sets are built from, with its table
// [stream] (docs/formats/catalogue.md).
//
// Example: a detector's training, 64 pictures at a time.
//   const Stream stream("training.toml", {.seed = 7});
//   for (std::int64_t i = 0; i < 64 * 1000; ++i) learn_from(stream.sample(i));
//
// A sample depends on the catalogue, the seed and its index alone, whatever was asked for before
// and by which thread or process. `airtruth render` of scene(index) makes the same pictures and
// truth, bit by bit, but for samples that [stream] other_cameras shows otherwise. Indices in a row
// share decoded frames ([stream] reuse), and are therefore made fastest; they are already mixed,
// from eight places of the backgrounds at a time.
//
// Threads may use a Stream at the same time. The constructor reads the catalogue alone; a
// background and an aircraft are opened where a sample first needs them. Throws Error for faults in
// the catalogue and in the files that it names.
class AIRTRUTH_API Stream {
 public:
  explicit Stream(const std::filesystem::path& catalogue_file, const StreamOptions& options = {});
  // The same for the text of a catalogue. Relative paths in it are relative to `folder`, and
  // messages name folder/"catalogue".
  static Stream from_text(std::string_view catalogue,
                          const std::filesystem::path& folder,
                          const StreamOptions& options = {});
  ~Stream();
  Stream(Stream&&) noexcept;
  Stream& operator=(Stream&&) noexcept;

  // index: from 0 to 2^40. Throws Interrupted after a stop.
  StreamSample sample(std::int64_t index) const;

  // The sample's scene as the text of a scene file, with absolute paths.
  std::string scene(std::int64_t index) const;

 private:
  struct State;
  explicit Stream(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace airtruth
