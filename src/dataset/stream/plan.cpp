// SPDX-License-Identifier: Apache-2.0
#include "dataset/stream/plan.h"

#include <algorithm>
#include <numeric>
#include <string>
#include <type_traits>
#include <utility>

#include <fmt/format.h>

#include "dataset/catalogue/drawing.h"
#include "dataset/catalogue/meeting.h"
#include "encounter/pairing/strata.h"
#include "foundation/base/error.h"
#include "sequence/setup/from_scene.h"

namespace airtruth::stream {
namespace {

// A container may state a frame or two more than it holds.
constexpr std::int64_t kFramesInDoubt = 2;

// Where the background of a run states a frame_count that is shorter than the run, the run goes on
// over others: hundreds of samples of one frame would follow each other else.
std::int64_t part_number(std::int64_t run, std::int64_t part) { return run * kRunFrames + part; }

// Where a sequence of the rule is longer than a sample.
bool is_passage(const catalogue::Drawn& rule) { return rule.approach.has_value(); }
bool is_passage(const catalogue::EncounterRule&) { return true; }

const catalogue::NumberedRule& numbered(
    const std::variant<catalogue::Drawn, catalogue::EncounterRule>& drawing) {
  return std::visit(
      [](const catalogue::NumberedRule& one) -> const auto& { return one; }, drawing);
}

// How much of a rule is over `background`.
double share_of(std::size_t background,
                const std::vector<std::size_t>& among,
                const std::vector<catalogue::Background>& all) {
  double sum = 0;
  for (const std::size_t place : among) sum += all[place].weight;
  return std::count(among.begin(), among.end(), background) > 0 ? all[background].weight / sum : 0;
}

// The scene of what happens from `time_s` on. Its paths are those of [[random]] and
// [[encounter_model]].
void begin_later(scene::Scene& scene, double time_s) {
  scene.camera.position_ned_m += time_s * scene.camera.velocity_ned_mps;
  for (scene::Intruder& intruder : scene.intruders) {
    for (double& at_s : intruder.times_s) at_s -= time_s;
    if (intruder.encounter) intruder.encounter->cpa_time_s -= time_s;
  }
}

// Propellers and rotors of the intruders at places of their own: the time of a sample's first frame
// is always 0, and models of one type share their parts.
void turn_propellers(scene::Scene& scene, std::uint64_t seed, std::int64_t index) {
  Random random = Seed(seed).stream("spin", static_cast<std::uint64_t>(index));
  for (scene::Intruder& intruder : scene.intruders)
    if (is_aircraft(intruder)) intruder.spin_time_s = random.uniform();
}

// A livery takes as long to load as tens of samples take to draw, and the hundreds of a catalogue
// are too many for memory. So rules with the same types share a fleet, a fleet flies kMostOfFleet
// aircraft at a time, or fewer where there are many fleets, and one aircraft of all fleets changes
// every kSamplesOfChange samples. Chosen: kMostAircraft of 8 MB, a large livery, fit into
// setup::SharedInputs::kMaxKeptBytes.
constexpr std::size_t kMostOfFleet = 16;
constexpr std::size_t kLeastOfFleet = 4;
constexpr std::size_t kMostAircraft = 64;
constexpr std::size_t kSamplesOfChange = 512;

std::size_t liveries_of(const std::vector<catalogue::AircraftType>& types) {
  std::size_t liveries = 0;
  for (const catalogue::AircraftType& type : types) liveries += type.liveries.size();
  return liveries;
}

}  // namespace

Place place_of(std::int64_t index, std::int64_t reuse) {
  const std::int64_t samples_of_run = kRunFrames * reuse;
  const std::int64_t turn = index / kLanes;  // of the lanes
  const std::int64_t lane = index % kLanes;
  return {
      turn / samples_of_run * kLanes + lane, turn % samples_of_run / reuse, turn % samples_of_run};
}

Planner::Planner(const catalogue::Catalogue& catalogue,
                 std::uint64_t seed,
                 std::function<const catalogue::BackgroundFiles&(std::size_t)> files,
                 setup::SharedInputs& shared)
    : catalogue_(catalogue), seed_(seed), files_(std::move(files)), shared_(shared) {
  for (const catalogue::Rule& given : catalogue.rules) {
    Rule rule{checked(given), 0, 1};
    check_backgrounds(numbered(rule.drawing).backgrounds);
    // An encounter's track needs a type that flies it.
    const bool is_encounter = std::holds_alternative<catalogue::EncounterRule>(rule.drawing);
    rule.fleet = fleet_with(
        {std::visit([](auto& one) { return std::exchange(one.types, {}); }, rule.drawing),
         is_encounter});
    rule.seed = Seed(seed).stream(numbered(rule.drawing).name)();
    rules_.push_back(std::move(rule));
  }
  std::size_t aircraft = 0;
  for (const Fleet& fleet : fleets_) aircraft += aircraft_at_a_time(fleet);
  samples_of_aircraft_ = static_cast<std::int64_t>(kSamplesOfChange * aircraft);
}

std::size_t Planner::fleet_with(Fleet fleet) {
  const auto same = std::find_if(fleets_.begin(), fleets_.end(), [&](const Fleet& other) {
    return other.types == fleet.types && other.every_type == fleet.every_type;
  });
  if (same != fleets_.end()) return static_cast<std::size_t>(same - fleets_.begin());
  fleet.seed = Seed(seed_).stream("fleet", fleets_.size())();
  fleets_.push_back(std::move(fleet));
  return fleets_.size() - 1;
}

std::size_t Planner::aircraft_at_a_time(const Fleet& fleet) const {
  const std::size_t most = std::clamp(kMostAircraft / fleets_.size(), kLeastOfFleet, kMostOfFleet);
  const std::size_t count = fleet.every_type ? std::max(most, fleet.types.size()) : most;
  return std::min(count, liveries_of(fleet.types));
}

// Types take turns, and a livery of each is drawn.
std::vector<catalogue::AircraftType> Planner::flying(const Fleet& fleet, std::int64_t index) const {
  const std::size_t count = aircraft_at_a_time(fleet);
  if (liveries_of(fleet.types) <= count) return fleet.types;
  const pairing::Strata turns(Seed(fleet.seed).stream("turns of types")(), fleet.types.size(), 1);
  std::vector<catalogue::AircraftType> types;
  for (std::size_t slot = 0; slot < count; ++slot) {
    const auto begin =
        static_cast<std::int64_t>(slot) * samples_of_aircraft_ / static_cast<std::int64_t>(count);
    const auto number =
        static_cast<std::uint64_t>((index + begin) / samples_of_aircraft_) * count + slot;
    Random random = Seed(fleet.seed).stream("aircraft", number);
    const std::size_t turn = (fleet.every_type ? slot : number) % fleet.types.size();
    const catalogue::AircraftType& type = catalogue::one_at(turns.spaced(turn, 0), fleet.types);
    types.push_back({type.name, {catalogue::one_of(random, type.liveries)}});
  }
  return types;
}

Planner::Drawing Planner::checked(const catalogue::Rule& rule) const {
  if (const auto* encounters = std::get_if<catalogue::EncounterRule>(&rule)) return *encounters;
  if (std::holds_alternative<catalogue::Product>(rule))
    throw Error(
        "a stream draws from [[random]] and [[encounter_model]]; expected a catalogue without "
        "[[sequence]] and [[product]]",
        {catalogue_.file.string()});
  auto drawn = std::get<catalogue::Drawn>(rule);
  if (!drawn.seen.empty())
    throw Error(
        "[[random.seen]] is about frames of a whole sequence, which a stream does not have; "
        "expected size_px, range_m or [random.encounter]",
        drawn.where);
  if (!is_passage(drawn)) drawn.frame_count = catalogue_.stream.frames;
  if (catalogue_.stream.intruders) {
    drawn.intruders = *catalogue_.stream.intruders;
    drawn.numbers_intruders = true;
  }
  return drawn;
}

void Planner::check_backgrounds(const std::vector<std::size_t>& places) const {
  for (const std::size_t place : places) {
    const catalogue::Background& background = catalogue_.backgrounds[place];
    if (background.camera.path_file || background.camera.log)
      throw Error("the camera of background '" + background.name +
                      "' has a path_file or log, which belongs to its first frame; expected a "
                      "stated camera, as a stream's samples are of any frames",
                  background.where);
  }
}

const Planner::Rule& Planner::drawn_rule(Random random,
                                         const std::function<double(const Rule&)>& share) const {
  std::vector<double> shares;
  for (const Rule& rule : rules_)
    shares.push_back(share(rule) * static_cast<double>(numbered(rule.drawing).count));
  double left = random.uniform() * std::accumulate(shares.begin(), shares.end(), 0.0);
  std::size_t last = 0;  // of those that may be drawn: sums are rounded
  for (std::size_t k = 0; k < rules_.size(); ++k) {
    if (shares[k] > 0) last = k;
    left -= shares[k];
    if (left < 0) break;
  }
  return rules_[last];
}

const Planner::Rule& Planner::rule_over(std::size_t background, std::int64_t index) const {
  return drawn_rule(
      Seed(seed_).stream("rule", static_cast<std::uint64_t>(index)), [&](const Rule& rule) {
        return share_of(background, numbered(rule.drawing).backgrounds, catalogue_.backgrounds);
      });
}

Planner::Run Planner::run_of(std::int64_t number, std::int64_t part) const {
  const auto of_part = static_cast<std::uint64_t>(part_number(number, part));
  const Rule& rule =
      drawn_rule(Seed(seed_).stream("rule of run", of_part), [](const Rule&) { return 1.0; });
  Random random = Seed(seed_).stream("run", of_part);
  Run run;
  run.background = catalogue::background_at(
      random.uniform(), numbered(rule.drawing).backgrounds, catalogue_.backgrounds);
  const catalogue::Background& background = catalogue_.backgrounds[run.background];
  const catalogue::BackgroundFiles& files = files_(run.background);
  if (files.frames <= 0)
    throw Error(
        files.video.string() + " does not state how many frames it has; expected a file that does",
        background.where);
  if (background.frame_count && *background.frame_count < catalogue_.stream.frames)
    throw Error(fmt::format("background '{}' has a frame_count of {}; expected the {} frames of a "
                            "sample, or more",
                            background.name,
                            *background.frame_count,
                            catalogue_.stream.frames),
                background.where);
  const std::int64_t doubtful = background.frame_count ? 0 : kFramesInDoubt;
  const std::int64_t places = std::max<std::int64_t>(
      1, files.frames - doubtful - background.first_frame - catalogue_.stream.frames + 1);
  run.frames = std::min(kRunFrames, places);
  run.first_frame =
      background.first_frame +
      static_cast<std::int64_t>(random.uniform() * static_cast<double>(places - run.frames + 1));
  return run;
}

Planned Planner::at(std::int64_t index) const {
  const Place place = place_of(index, catalogue_.stream.reuse);
  Run run = run_of(place.run, 0);
  const bool is_part = catalogue_.backgrounds[run.background].frame_count.has_value();
  const std::int64_t part = is_part ? place.step / run.frames : 0;
  if (part > 0) run = run_of(place.run, part);
  const std::int64_t first_frame = run.first_frame + place.step % run.frames;
  const std::int64_t samples_of_run = kRunFrames * catalogue_.stream.reuse;
  Planned planned{
      scene_of(rule_over(run.background, index),
               {run.background, first_frame, place.run * samples_of_run + place.sample_of_run},
               index),
      run.background,
      part_number(place.run, part)};
  // The samples of one frame share their motion, and with it their seed.
  const std::uint64_t seed_of_run =
      Seed(seed_).stream("seeds of run", static_cast<std::uint64_t>(place.run))();
  planned.scene.seed =
      Seed(seed_of_run).stream("frame", static_cast<std::uint64_t>(first_frame))() >> 1;
  return planned;
}

scene::Scene Planner::scene_of(const Rule& rule,
                               const catalogue::StreamPlace& place,
                               std::int64_t index) const {
  return std::visit(
      [&](auto drawing) {
        constexpr bool kEncounters = std::is_same_v<decltype(drawing), catalogue::EncounterRule>;
        if constexpr (kEncounters)
          drawing.seed = Seed(rule.seed).stream(
              "count", static_cast<std::uint64_t>(place.index / drawing.count))();
        drawing.types = flying(fleets_[rule.fleet], index);
        catalogue::Item item = catalogue::stream_item(catalogue_, drawing, place, rule.seed);
        // Encounters draw their intruders when they are placed, and all others are placed by their
        // size.
        turn_propellers(item.scene, rule.seed, index);
        catalogue::place(item, catalogue_, files_(place.background), &shared_);
        if (kEncounters) turn_propellers(item.scene, rule.seed, index);
        if (is_passage(drawing))
          keep_part_in_view(
              item, Seed(rule.seed).stream("part", static_cast<std::uint64_t>(place.index)));
        return std::move(item.scene);
      },
      rule.drawing);
}

// Keeps as many frames of the item's sequence as a sample has: some that show an aircraft, where
// there are any.
void Planner::keep_part_in_view(catalogue::Item& item, Random random) const {
  const catalogue::BackgroundFiles& files = files_(item.background);
  const lens::ImageSize size{files.width, files.height};
  const catalogue::Views views{
      setup::lens_of(item.scene.lens, size), item.frame_count, files.frame_rate_hz};
  const std::int64_t last = std::max<std::int64_t>(0, item.frame_count - catalogue_.stream.frames);
  std::vector<std::int64_t> frames;
  for (const scene::Intruder& intruder : item.scene.intruders)
    if (scene::is_aircraft(intruder))
      for (const std::int64_t frame : catalogue::frames_in_view(intruder, item.scene.camera, views))
        if (frame <= last) frames.push_back(frame);
  const double share = random.uniform();
  const std::int64_t first =
      frames.empty() ? static_cast<std::int64_t>(share * static_cast<double>(last + 1))
                     : frames[static_cast<std::size_t>(share * static_cast<double>(frames.size()))];
  begin_later(item.scene, static_cast<double>(first) / files.frame_rate_hz);
  item.scene.background.frame_count = catalogue_.stream.frames;
  catalogue::lay_distractors(
      item.scene,
      item.distractors,
      catalogue::clip_over(files, item.scene.background.first_frame, catalogue_.stream.frames),
      &shared_);
}

}  // namespace airtruth::stream
