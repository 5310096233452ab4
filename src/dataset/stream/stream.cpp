// SPDX-License-Identifier: Apache-2.0
#include "dataset/stream/stream.h"

#include <algorithm>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <tbb/task_arena.h>

#include "dataset/build/inputs.h"
#include "dataset/catalogue/expand.h"
#include "dataset/stream/frames.h"
#include "dataset/stream/other_camera.h"
#include "dataset/stream/plan.h"
#include "foundation/base/error.h"
#include "foundation/base/file_state.h"
#include "foundation/base/files.h"
#include "foundation/base/seed.h"
#include "foundation/disk_cache/disk_cache.h"
#include "foundation/image/contrast_to_noise.h"
#include "foundation/image/layer.h"
#include "labels/annotation/object_class.h"
#include "picture/composite/cover.h"
#include "picture/video/writer.h"
#include "sequence/insertion/masks.h"
#include "sequence/pipeline/frame_maker.h"
#include "sequence/setup/shared_inputs.h"

namespace airtruth::stream {
namespace {

// A background that was opened.
struct Clip {
  catalogue::BackgroundFiles files;
  video::StreamInfo info;
};

// Scenes whose render() keeps every sample.
catalogue::Catalogue adapted(catalogue::Catalogue catalogue) {
  catalogue.output.video = video::Format::kMkv;
  catalogue.output.masks = false;
  return catalogue;
}

// An even offset from low to high, at a share from 0 to 1; where there is none, the one below high.
int placed(double share, int low, int high) {
  const int first = (low + 1) / 2;
  const int last = high / 2;
  if (first > last) return 2 * last;
  return 2 * (first + static_cast<int>(share * static_cast<double>(last - first + 1)));
}

}  // namespace

struct Stream::State {
  State(catalogue::Catalogue given, std::uint64_t seed_value, pipeline::Options wanted)
      : catalogue(adapted(std::move(given))),
        seed(Seed(catalogue.seed).stream("stream", seed_value)()),
        options(std::move(wanted)),
        shared(pipeline::inputs_of(options)),
        planner(
            catalogue,
            seed,
            [this](std::size_t i) -> const auto& { return clip(i).files; },
            *shared),
        frames(static_cast<std::size_t>(catalogue.stream.memory_mb) * 1'000'000),
        clips(catalogue.backgrounds.size()),
        arena(options.threads > 0 ? pipeline::arena_threads(options.threads)
                                  : tbb::task_arena::automatic) {
    options.shared = shared;
    options.threads = 1;  // of decoders
    if (options.warn)
      options.warn = [this, warn = options.warn](const std::string& text) {
        const std::lock_guard lock(warning);
        if (said.size() < kMostSaid && said.insert(text).second) warn(text);
      };
  }

  const Clip& clip(std::size_t background) {
    const std::lock_guard lock(opening);
    std::optional<Clip>& clip = clips[background];
    if (!clip) {
      const catalogue::Background& stated = catalogue.backgrounds[background];
      const bool is_flight = std::holds_alternative<synthetic::FlightOptions>(stated.source);
      const catalogue::Folder folder = flights(stated);
      if (is_flight && !options.use_cache)
        throw Error("background '" + stated.name +
                        "' is a virtual flight, which a stream makes in the cache; expected a "
                        "video, or a cache",
                    stated.where);
      build::BuildOptions how;
      how.stop = options.stop;
      // One of a training's workers makes a flight, the others find it.
      std::optional<WaitingLock> lock_of_flight;
      if (is_flight)
        lock_of_flight.emplace(folder.backgrounds() / ("." + stated.name + ".lock"), options.stop);
      clip = Clip{build::prepare(stated, folder, how), {}};
      scene::Scene scene = catalogue::scene_over(catalogue, background);
      scene.background.video = clip->files.video;
      clip->info = pipeline::open_background(scene, options).info();
    }
    return *clip;
  }

  // A virtual flight is made once for all streams of the same catalogue and lens.
  catalogue::Folder flights(const catalogue::Background& background) const {
    const auto key =
        disk_cache::Key("flight").add(catalogue.text).add(build::sha256_of_flight_lens(background));
    return catalogue::Folder(pipeline::cache_folder(options, "flights") / key.name().substr(0, 16));
  }

  Planned planned(std::int64_t index) const {
    if (index < 0 || index > kMostIndex)
      throw Error(fmt::format("the index of a sample is {}; expected 0 to {}", index, kMostIndex));
    return planner.at(index);
  }

  std::shared_ptr<const Shot> shot_of(const Planned& planned, const pipeline::OpenedScene& opened) {
    const scene::Scene& scene = planned.scene;
    return frames.at(
        {scene.background.video,
         planned.run,
         scene.background.first_frame,
         catalogue.stream.frames,
         [&](std::int64_t first) {
           scene::Scene from = scene;
           from.background.first_frame = first;
           from.background.frame_count.reset();
           return pipeline::open_background(from, options);
         },
         [&](const std::vector<video::Frame>& all) { return motion_of(opened, all); }});
  }

  std::vector<setup::MotionSource::Measured> motion_of(const pipeline::OpenedScene& opened,
                                                       const std::vector<video::Frame>& all) {
    const auto source =
        setup::MotionSource::of_frames(pipeline::motion_inputs(opened, "", options), all);
    std::vector<setup::MotionSource::Measured> motion;
    for (std::size_t k = 0; k < all.size(); ++k) motion.push_back(source.at(k));
    return motion;
  }

  Sample made(std::int64_t index) {
    const Planned plan = planned(index);
    pipeline::OpenedScene opened =
        pipeline::open_over(clip(plan.background).info, plan.scene, options);
    pipeline::measure_camera(opened, options);
    const std::shared_ptr<const Shot> shot = shot_of(plan, opened);
    pipeline::FrameMaker maker(pipeline::resolved_by_truth(std::move(opened)), options.stop);
    Sample sample{catalogue.backgrounds[plan.background].name,
                  plan.scene.background.first_frame,
                  plan.scene.weight,
                  {},
                  {}};
    std::vector<std::vector<composite::AlphaMask>> masks(shot->frames.size());
    for (std::size_t k = 0; k < shot->frames.size(); ++k) {
      pipeline::Work work;
      work.frame = copy_of(shot->frames[k]);
      work.moved = shot->motion[k];
      maker.locate(work, work.moved.shake);
      maker.draw(work);
      maker.compose(work);
      const image::Layer layer = work.painted.layer;
      maker.describe(work);
      if (options.stop.stop_requested()) throw Interrupted();
      masks[k] = insertion::alpha_masks(work.truth, layer);
      sample.frames.push_back({std::move(work.frame.picture), std::move(work.truth), {}, {}});
    }
    sample.crop = crop_of(index, sample);
    const std::optional<OtherCamera> camera = other_camera_of(index);
    for (std::size_t k = 0; k < masks.size(); ++k) {
      Sample::Frame& frame = sample.frames[k];
      frame.picture = image::crop(frame.picture, sample.crop);
      if (camera) show_through(*camera, index, k, sample);
      for (const composite::AlphaMask& mask : masks[k]) {
        if (catalogue.stream.masks) frame.masks.push_back(insertion::samples_in(mask, sample.crop));
        std::optional<PixelBox>& covered = frame.covered.emplace_back();
        if (const auto seen = composite::covered(mask, sample.crop))
          covered = {seen->box.x - sample.crop.x,
                     seen->box.y - sample.crop.y,
                     seen->box.width,
                     seen->box.height};
      }
    }
    return sample;
  }

  // Empty: the background's own.
  std::optional<OtherCamera> other_camera_of(std::int64_t index) const {
    const Seed cameras(Seed(seed).stream("other camera", static_cast<std::uint64_t>(index))());
    if (cameras.stream("share").uniform() >= catalogue.stream.other_cameras) return std::nullopt;
    return drawn_camera(cameras.stream("camera"));
  }

  // Frame k of a sample as the camera shows it, and how its intruders stand out there.
  void show_through(const OtherCamera& camera,
                    std::int64_t index,
                    std::size_t k,
                    Sample& sample) const {
    Sample::Frame& frame = sample.frames[k];
    const std::uint64_t noise =
        Seed(Seed(seed).stream("other noise", static_cast<std::uint64_t>(index))())
            .stream("frame", k)();
    frame.picture = seen_through(camera, frame.picture, noise);
    for (annotation::Intruder& intruder : frame.truth.intruders) {
      if (!intruder.contrast_to_noise) continue;
      PixelBox box = *annotation::box_to_show(intruder);
      const bool is_whole = intersection(box, sample.crop) == box;
      box.x -= sample.crop.x;
      box.y -= sample.crop.y;
      intruder.contrast_to_noise =
          is_whole ? image::contrast_to_noise(frame.picture, box) : std::nullopt;
    }
  }

  // A crop that shows one of the aircraft whole in all frames, else one of the distractors, as far
  // as it fits; anywhere where nothing is visible.
  PixelBox crop_of(std::int64_t index, const Sample& sample) const {
    const image::Picture& picture = sample.frames.front().picture;
    if (!catalogue.stream.crop_px) return {0, 0, picture.width, picture.height};
    const auto [width, height] = *catalogue.stream.crop_px;
    if (width > picture.width || height > picture.height)
      throw Error(fmt::format("[stream] size_px is {} x {}; the frames of background '{}' are {} x "
                              "{} px, expected no more",
                              width,
                              height,
                              sample.background,
                              picture.width,
                              picture.height),
                  {catalogue.file.string()});
    Random random = Seed(seed).stream("crop", static_cast<std::uint64_t>(index));
    const double which = random.uniform();
    const double across = random.uniform();
    const double down = random.uniform();
    const int last_x = picture.width - width;
    const int last_y = picture.height - height;
    const std::optional<PixelBox> shown = shown_by_crop(sample, which);
    if (!shown) return {placed(across, 0, last_x), placed(down, 0, last_y), width, height};
    return {placed(across, std::max(0, shown->right() - width), std::min(last_x, shown->x)),
            placed(down, std::max(0, shown->bottom() - height), std::min(last_y, shown->y)),
            width,
            height};
  }

  // Bounds in all frames of the one at share `which` of the visible aircraft, else distractors.
  static std::optional<PixelBox> shown_by_crop(const Sample& sample, double which) {
    std::vector<std::optional<PixelBox>> aircraft;
    std::vector<std::optional<PixelBox>> others;
    const std::size_t count = sample.frames.front().truth.intruders.size();
    for (std::size_t i = 0; i < count; ++i) {
      std::optional<PixelBox> all;
      for (const Sample::Frame& frame : sample.frames)
        if (const auto box = annotation::box_to_show(frame.truth.intruders[i]))
          all = all ? bounds(*all, *box) : *box;
      if (!all) continue;
      const auto& object_class = sample.frames.front().truth.intruders[i].object_class;
      (annotation::is_aircraft(object_class) ? aircraft : others).push_back(all);
    }
    const auto& among = aircraft.empty() ? others : aircraft;
    if (among.empty()) return std::nullopt;
    return among[static_cast<std::size_t>(which * static_cast<double>(among.size()))];
  }

  // Different warnings that a stream passes on: chosen.
  static constexpr std::size_t kMostSaid = 1000;
  static constexpr std::int64_t kMostIndex = std::int64_t{1} << 40;

  const catalogue::Catalogue catalogue;
  const std::uint64_t seed;
  pipeline::Options options;
  const std::shared_ptr<setup::SharedInputs> shared;
  const Planner planner;
  Frames frames;
  std::mutex opening;
  std::vector<std::optional<Clip>> clips;
  std::mutex warning;
  std::set<std::string> said;
  tbb::task_arena arena;
};

Stream::Stream(catalogue::Catalogue catalogue, std::uint64_t seed, pipeline::Options options)
    : state_(std::make_unique<State>(std::move(catalogue), seed, std::move(options))) {}
Stream::~Stream() = default;

Sample Stream::sample(std::int64_t index) const {
  if (state_->options.stop.stop_requested()) throw Interrupted();
  return state_->arena.execute([&] { return state_->made(index); });
}

scene::Scene Stream::scene(std::int64_t index) const { return state_->planned(index).scene; }

bool Stream::has_masks() const { return state_->catalogue.stream.masks; }

}  // namespace airtruth::stream
