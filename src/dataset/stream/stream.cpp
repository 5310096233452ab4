// SPDX-License-Identifier: Apache-2.0
#include "dataset/stream/stream.h"

#include <algorithm>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <tbb/task_arena.h>

#include "dataset/build/backgrounds.h"
#include "dataset/catalogue/expand.h"
#include "dataset/stream/frames.h"
#include "dataset/stream/places.h"
#include "encounter/pairing/strata.h"
#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/base/seed.h"
#include "labels/annotation/object_class.h"
#include "sequence/pipeline/frame_maker.h"
#include "sequence/setup/shared_inputs.h"

namespace airtruth::stream {
namespace {

namespace fs = std::filesystem;

// A container may state a frame or two more than it holds.
constexpr std::int64_t kFramesInDoubt = 2;

// A background that was opened.
struct Clip {
  catalogue::BackgroundFiles files;
  video::StreamInfo info;
};

// Aircraft that a rule flies at a time, and for how many samples each does. A livery takes as long
// to load as tens of samples take to draw, and the hundreds of a catalogue are too many for memory.
// One aircraft changes every 512 samples. Chosen.
constexpr std::size_t kFleet = 16;
constexpr std::int64_t kSamplesOfAircraft = 8192;

// A rule of [[random]], which is drawn with a few of its types at a time.
struct Rule {
  catalogue::Drawn drawn;  // without types
  std::vector<catalogue::AircraftType> types;
};

// The frames that a run of samples is over.
struct Run {
  const Rule* rule = nullptr;
  std::size_t background = 0;
  std::int64_t first_frame = 0;  // in the video
  std::int64_t frames = 1;       // at which a sample may begin
};

std::vector<Rule> rules_of(const catalogue::Catalogue& catalogue) {
  std::vector<Rule> rules;
  for (const catalogue::Rule& rule : catalogue.rules) {
    Rule& one = rules.emplace_back(Rule{std::get<catalogue::Drawn>(rule), {}});
    one.types = std::exchange(one.drawn.types, {});
  }
  return rules;
}

// The aircraft that fly in a sample: the types take turns.
std::vector<catalogue::AircraftType> fleet_of(const Rule& rule,
                                              std::uint64_t seed,
                                              std::int64_t index) {
  std::size_t liveries = 0;
  for (const catalogue::AircraftType& type : rule.types) liveries += type.liveries.size();
  if (liveries <= kFleet) return rule.types;
  const pairing::Strata turns(
      Seed(seed).stream("turns of types of " + rule.drawn.name)(), rule.types.size(), 1);
  std::vector<catalogue::AircraftType> fleet;
  for (std::size_t slot = 0; slot < kFleet; ++slot) {
    const auto begin = static_cast<std::int64_t>(slot) * kSamplesOfAircraft / std::int64_t{kFleet};
    const auto number =
        static_cast<std::uint64_t>((index + begin) / kSamplesOfAircraft) * kFleet + slot;
    Random random = Seed(seed).stream("aircraft of " + rule.drawn.name, number);
    const catalogue::AircraftType& type =
        catalogue::one_at(turns.middle(number % rule.types.size(), 0), rule.types);
    fleet.push_back({type.name, {catalogue::one_of(random, type.liveries)}});
  }
  return fleet;
}

// The rules as the stream draws them.
catalogue::Catalogue adapted(catalogue::Catalogue catalogue) {
  for (catalogue::Rule& rule : catalogue.rules) {
    auto* drawn = std::get_if<catalogue::Drawn>(&rule);
    if (drawn == nullptr)
      throw Error(
          "a stream draws from [[random]]; expected a catalogue without [[sequence]], [[product]] "
          "and [[encounter_model]]",
          {catalogue.file.string()});
    drawn->frame_count = catalogue.stream.frames;
    if (catalogue.stream.intruders) {
      drawn->intruders = *catalogue.stream.intruders;
      drawn->numbers_intruders = true;
    }
    for (const std::size_t i : drawn->backgrounds)
      if (catalogue.backgrounds[i].camera.path_file || catalogue.backgrounds[i].camera.log)
        throw Error("the camera of background '" + catalogue.backgrounds[i].name +
                        "' has a path_file or log, which belongs to its first frame; expected a "
                        "stated camera, as a stream's samples are of any frames",
                    catalogue.backgrounds[i].where);
  }
  catalogue.output.video = scene::OutputVideo::kMkv;  // keeps every sample
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
        rules(rules_of(catalogue)),
        seed(Seed(catalogue.seed).stream("stream", seed_value)()),
        options(std::move(wanted)),
        frames(static_cast<std::size_t>(catalogue.stream.memory_mb) * 1'000'000),
        clips(catalogue.backgrounds.size()),
        arena(options.threads > 0 ? options.threads : tbb::task_arena::automatic) {
    if (!options.shared)
      options.shared = std::make_shared<setup::SharedInputs>(
          pipeline::cache_folder(options, "ambient_occlusion"));
    options.threads = 1;  // of decoders
    if (options.warn)
      options.warn = [this, warn = options.warn](const std::string& text) {
        const std::lock_guard lock(warning);
        warn(text);
      };
  }

  const Clip& clip(std::size_t background) {
    const std::lock_guard lock(opening);
    std::optional<Clip>& clip = clips[background];
    if (!clip) {
      build::BuildOptions how;
      how.stop = options.stop;
      clip = Clip{build::prepare(catalogue.backgrounds[background], flights(), how), {}};
      scene::Scene scene = catalogue::scene_over(catalogue, background);
      scene.background.video = clip->files.video;
      clip->info = pipeline::open_background(scene, options).info();
    }
    return *clip;
  }

  // Virtual flights are made once for all streams of the same catalogue.
  catalogue::Folder flights() const {
    return catalogue::Folder(pipeline::cache_folder(options, "flights") /
                             sha256_of(catalogue.text).substr(0, 16));
  }

  Run run_of(std::int64_t number) {
    Random random = Seed(seed).stream("run", static_cast<std::uint64_t>(number));
    Run run{&drawn_rule(random), 0, 0, 1};
    run.background = drawn_background(random, run.rule->drawn.backgrounds);
    const Clip& of = clip(run.background);
    if (of.files.frames <= 0)
      throw Error(of.files.video.string() +
                      " does not state how many frames it has; expected a file that does",
                  catalogue.backgrounds[run.background].where);
    const std::int64_t first = catalogue.backgrounds[run.background].first_frame;
    const std::int64_t places = std::max<std::int64_t>(
        1, of.files.frames - kFramesInDoubt - first - catalogue.stream.frames + 1);
    run.frames = std::min(kRunFrames, places);
    run.first_frame =
        first + static_cast<std::int64_t>(random.uniform() * double(places - run.frames + 1));
    return run;
  }

  // A rule as often as it has sequences.
  const Rule& drawn_rule(Random& random) const {
    std::int64_t all = 0;
    for (const Rule& rule : rules) all += rule.drawn.count;
    auto left = static_cast<std::int64_t>(random.uniform() * static_cast<double>(all));
    for (const Rule& rule : rules) {
      if (left < rule.drawn.count) return rule;
      left -= rule.drawn.count;
    }
    return rules.back();
  }

  std::size_t drawn_background(Random& random, const std::vector<std::size_t>& among) const {
    double all = 0;
    for (const std::size_t i : among) all += catalogue.backgrounds[i].weight;
    double left = random.uniform() * all;
    for (const std::size_t i : among) {
      left -= catalogue.backgrounds[i].weight;
      if (left < 0) return i;
    }
    return among.back();
  }

  // The scene of a sample, and the run that it belongs to.
  struct Planned {
    std::unique_ptr<const catalogue::Drawn> rule;  // of the item
    catalogue::Item item;
    Place place;
  };
  Planned planned(std::int64_t index) {
    check(index >= 0 && index <= kMostIndex, "a sample's index is from 0 to 2^53");
    const Place place = place_of(index, catalogue.stream.reuse);
    const Run run = run_of(place.run);
    const std::int64_t samples_of_run = kRunFrames * catalogue.stream.reuse;
    auto rule = std::make_unique<catalogue::Drawn>(run.rule->drawn);
    rule->types = fleet_of(*run.rule, seed, index);
    catalogue::Item item =
        catalogue::stream_item(catalogue,
                               *rule,
                               {run.background,
                                run.first_frame + place.step % run.frames,
                                place.run * samples_of_run + place.sample_of_run},
                               seed);
    catalogue::place(item, catalogue, clip(run.background).files, options.shared.get());
    // The samples of one frame share their motion, and with it their seed.
    item.scene.seed =
        Seed(seed).stream("frame",
                          static_cast<std::uint64_t>(place.run * kRunFrames + place.step))() >>
        1;
    return {std::move(rule), std::move(item), place};
  }

  std::shared_ptr<const Shot> shot_of(const Planned& planned, const pipeline::OpenedScene& opened) {
    const scene::Scene& scene = planned.item.scene;
    return frames.at(
        {planned.place.run,
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
        pipeline::open_over(clip(plan.item.background).info, plan.item.scene, options);
    pipeline::measure_camera(opened, options);
    const std::shared_ptr<const Shot> shot = shot_of(plan, opened);
    pipeline::FrameMaker maker(pipeline::resolved_by_truth(std::move(opened)), options.stop);
    Sample sample{catalogue.backgrounds[plan.item.background].name,
                  plan.item.scene.background.first_frame,
                  {},
                  {}};
    for (std::size_t k = 0; k < shot->frames.size(); ++k) {
      pipeline::Work work;
      work.frame = copy_of(shot->frames[k]);
      work.moved = shot->motion[k];
      maker.locate(work, work.moved.shake);
      maker.draw(work);
      maker.compose(work);
      maker.describe(work);
      if (options.stop.stop_requested()) throw Interrupted();
      sample.frames.push_back({std::move(work.frame.picture), std::move(work.truth)});
    }
    sample.crop = crop_of(index, sample);
    for (Sample::Frame& frame : sample.frames)
      frame.picture = image::crop(frame.picture, sample.crop);
    return sample;
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
        if (const auto& box = shown_box(frame.truth.intruders[i]))
          all = all ? bounds(*all, *box) : *box;
      if (!all) continue;
      const auto& object_class = sample.frames.front().truth.intruders[i].object_class;
      (annotation::is_aircraft(object_class) ? aircraft : others).push_back(all);
    }
    const auto& among = aircraft.empty() ? others : aircraft;
    if (among.empty()) return std::nullopt;
    return among[static_cast<std::size_t>(which * static_cast<double>(among.size()))];
  }

  static std::optional<PixelBox> shown_box(const annotation::Intruder& intruder) {
    return intruder.covered_box_px ? intruder.covered_box_px : intruder.visible_box_px;
  }

  static constexpr std::int64_t kMostIndex = std::int64_t{1} << 53;

  const catalogue::Catalogue catalogue;
  const std::vector<Rule> rules;
  const std::uint64_t seed;
  pipeline::Options options;
  Frames frames;
  std::mutex opening;
  std::vector<std::optional<Clip>> clips;
  std::mutex warning;
  tbb::task_arena arena;
};

Stream::Stream(catalogue::Catalogue catalogue, std::uint64_t seed, pipeline::Options options)
    : state_(std::make_unique<State>(std::move(catalogue), seed, std::move(options))) {}
Stream::~Stream() = default;

Sample Stream::sample(std::int64_t index) const {
  if (state_->options.stop.stop_requested()) throw Interrupted();
  return state_->arena.execute([&] { return state_->made(index); });
}

scene::Scene Stream::scene(std::int64_t index) const { return state_->planned(index).item.scene; }

}  // namespace airtruth::stream
