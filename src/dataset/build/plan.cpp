// SPDX-License-Identifier: Apache-2.0
#include "dataset/build/plan.h"

#include <algorithm>
#include <utility>

#include "dataset/build/inputs.h"
#include "dataset/catalogue/meeting.h"
#include "dataset/labelled/labelled_set.h"
#include "foundation/base/error.h"
#include "scene/scene/camera_keys.h"
#include "sequence/pipeline/resolved_scene.h"
#include "sequence/setup/flyable.h"
#include "sequence/setup/from_scene.h"

namespace airtruth::build {
namespace {

// What a set costs, in seconds of a core where nothing else is said; docs/scaling.md has where each
// number was measured.
struct Costs {
  // Each is of a frame of 1280x960, and proportional to the pixels of others.
  double frame = 0.034;       // one intruder, motion known
  double flown = 0.069;       // of a virtual flight
  double calibrated = 0.044;  // of a background whose camera is measured
  double decoded = 0.005;     // that is only decoded
  // Of each thing in the air or on the lens after the first, in a frame.
  double thing_in_picture = 0.005;

  // These do not depend on the size.
  double start = 0.8;     // of the program
  double sequence = 0.3;  // begun and ended
  double thing = 0.009;   // a bird or another thing made
  double thing_in_frame = 0.0002;
  double motion = 0.0025;  // of a frame whose motion is measured
  // What a camera and the air do to the intruder in a frame, and the factor by which they make the
  // other things dearer.
  double camera_model = 0.002;
  double things_in_camera_model = 1.5;
  // Frames that are decoded before a clip that does not begin with its video: half of the distance
  // of key frames that x264 has by default.
  double sought_frames = 125;
};
constexpr Costs kCosts;
constexpr double kBytesPerFrame = 15'000;
constexpr double kBytesPerSequence = 580'000;  // preview.jpg
constexpr double kUsualPixels = 1280.0 * 960.0;

bool has_camera_model(const scene::Scene& scene) {
  return scene.realism.automatic || scene.realism.file || scene::states_any_key(scene.camera_model);
}

class Planner {
 public:
  explicit Planner(const catalogue::Catalogue& catalogue)
      : catalogue_(catalogue), facts_(catalogue.backgrounds.size()) {}

  void add(catalogue::Item& item) {
    const Facts& facts = facts_of(item.background);
    const catalogue::Draws draws = catalogue::draw_in_view(item, catalogue_, facts.files);
    plan_.draws += draws.drawn;
    plan_.never_in_view += draws.unseen;
    const std::int64_t first_frame = catalogue_.backgrounds[item.background].first_frame;
    const std::int64_t frames =
        catalogue::clip_over(facts.files, first_frame, item.frame_count).frames;
    if (item.frame_count > 0) item.frame_count = frames;
    ++plan_.sequences;
    plan_.frames += frames;
    plan_.open_ended += frames == 0 ? 1 : 0;
    plan_.core_s += cost_of(item, frames, facts.size);
    count_motion(item, frames);
    plan_.bytes +=
        static_cast<double>(frames) * facts.size * kBytesPerFrame + kBytesPerSequence * facts.size;
    count_things(item.scene);
    for (const catalogue::Encounter& encounter : item.drawn.encounters) {
      if (encounter.size_px) plan_.sizes_px.push_back(*encounter.size_px);
      if (encounter.range_m) plan_.ranges_m.push_back(*encounter.range_m);
    }
    const double rate_hz = facts.files.frame_rate_hz > 0 ? facts.files.frame_rate_hz : 30;
    fly(item, frames > 0 ? static_cast<double>(frames - 1) / rate_hz : 1e9);
  }

  Plan result() {
    plan_.core_s += plan_.sequences > 0 ? kCosts.start : 0;
    // The motion of a background is measured once for all its sequences that begin with it.
    for (std::size_t i = 0; i < facts_.size(); ++i)
      if (facts_[i])
        plan_.core_s += static_cast<double>(facts_[i]->moved_frames) *
                        (kCosts.motion + facts_[i]->size * kCosts.decoded);
    return std::move(plan_);
  }

 private:
  // Of a sequence by itself.
  double cost_of(const catalogue::Item& item, std::int64_t frames, double size) const {
    const scene::Scene& scene = item.scene;
    const std::ptrdiff_t things = std::ssize(scene.intruders) + std::ssize(scene.lens_marks);
    const auto distractors =
        static_cast<double>(things - std::ranges::count_if(scene.intruders, scene::is_aircraft));
    const auto others = static_cast<double>(std::max<std::ptrdiff_t>(1, things) - 1);
    const bool has_camera = has_camera_model(scene);
    const double other = (kCosts.thing_in_frame + size * kCosts.thing_in_picture) *
                         (has_camera ? kCosts.things_in_camera_model : 1);
    double per_frame =
        size * kCosts.frame + others * other + (has_camera ? kCosts.camera_model : 0);
    double cost = kCosts.sequence + distractors * kCosts.thing;
    if (item.has_random_start() && scene.motion.model != scene::MotionModel::kNone)
      per_frame += kCosts.motion;
    if (item.has_random_start() || catalogue_.backgrounds[item.background].first_frame > 0)
      cost += kCosts.sought_frames * size * kCosts.decoded;
    return cost + static_cast<double>(frames) * per_frame;
  }

  void count_motion(const catalogue::Item& item, std::int64_t frames) {
    if (item.has_random_start() || item.scene.motion.model == scene::MotionModel::kNone) return;
    std::int64_t& moved = facts_[item.background]->moved_frames;
    moved = std::max(moved, frames);
  }

  void count_things(const scene::Scene& scene) {
    std::int64_t aircraft = 0;
    for (const scene::Intruder& intruder : scene.intruders) {
      if (is_aircraft(intruder)) {
        ++aircraft;
        ++plan_.aircraft[sequences::category_of(intruder.aircraft)][intruder.aircraft];
      } else {
        ++plan_.distractors[enum_name(intruder.distractor->kind)];
      }
    }
    for (const scene::LensMark& mark : scene.lens_marks) ++plan_.distractors[enum_name(mark.kind)];
    plan_.negatives += aircraft == 0 ? 1 : 0;
    plan_.intruders += aircraft;
  }

  // Of a background.
  struct Facts {
    catalogue::BackgroundFiles files;  // without the files themselves
    // Pixels of a frame relative to 1280x960.
    double size = 1;
    std::int64_t moved_frames = 0;  // whose motion is measured for all sequences
  };

  // Facts of a background in use; the first call also counts the cost of the background itself.
  const Facts& facts_of(std::size_t i) {
    if (facts_[i]) return *facts_[i];
    const catalogue::Background& background = catalogue_.backgrounds[i];
    Facts& facts = facts_[i].emplace();
    take_facts(stream_of(background), facts.files);
    facts.size = double(facts.files.width) * facts.files.height / kUsualPixels;
    if (const auto* video = std::get_if<fs::path>(&background.source))
      facts.files.camera = camera_with_log(background, *video);
    const double whole = static_cast<double>(facts.files.frames) * facts.size;
    if (std::holds_alternative<synthetic::FlightOptions>(background.source))
      plan_.core_s += whole * kCosts.flown;
    if (pipeline::needs_calibration(catalogue::scene_over(catalogue_, i))) {
      plan_.calibration_s += whole * kCosts.calibrated;
      plan_.core_s += whole * kCosts.calibrated;
    }
    facts.files.frames = end_of(background, facts.files.frames);
    return facts;
  }

  // Why an intruder cannot fly its path, or has none; "" where it can.
  static std::string words_of_flight(const scene::Intruder& intruder,
                                     const trajectory::Path& camera,
                                     double clip_s) {
    try {
      return setup::words_beyond_limits(
          intruder.aircraft, setup::path_of(intruder, camera), 0, clip_s);
    } catch (const Error& error) {
      if (!intruder.encounter) throw;
      return error.message();  // a drawn encounter that no path fulfils
    }
  }

  // The speed, climb and bank of random paths are known before place(); the range does not change
  // them.
  void fly(const catalogue::Item& item, double clip_s) {
    const trajectory::Path camera = setup::camera_path(item.scene.camera);
    for (const scene::Intruder& intruder : item.scene.intruders) {
      // The path of what is seen follows from the measured motion.
      if (!intruder.seen.empty() || !is_aircraft(intruder)) continue;
      const std::string words = words_of_flight(intruder, camera, clip_s);
      if (words.empty()) continue;
      ++plan_.not_flyable;
      if (plan_.not_flyable_words.size() < Plan::kMaxNamed)
        plan_.not_flyable_words.push_back(item.name + ": " + words);
    }
  }

  const catalogue::Catalogue& catalogue_;
  std::vector<std::optional<Facts>> facts_;  // by background; empty: not in use so far
  Plan plan_;
};

}  // namespace

Plan plan_of(const catalogue::Catalogue& catalogue,
             const std::function<void(const catalogue::Item&)>& each,
             const std::stop_token& stop) {
  const catalogue::Expansion expansion(catalogue);
  Planner planner(catalogue);
  for (std::int64_t i = 0; i < expansion.size(); ++i) {
    if (stop.stop_requested()) throw Interrupted();
    catalogue::Item item = expansion.at(i);
    planner.add(item);
    if (each) each(item);
  }
  return planner.result();
}

}  // namespace airtruth::build
