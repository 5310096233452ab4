// SPDX-License-Identifier: Apache-2.0
#include "dataset/build/plan.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "dataset/build/backgrounds.h"
#include "dataset/labelled/labelled_set.h"
#include "foundation/base/error.h"
#include "sequence/pipeline/render.h"
#include "sequence/setup/flyable.h"
#include "sequence/setup/from_scene.h"
#include "sequence/setup/world.h"

namespace airtruth::build {
namespace {

// Cost of a frame of 1280x960 (docs/scaling.md); the cost of other sizes is proportional to their
// pixels.
constexpr double kCoreSecondsPerFrame = 0.034;
constexpr double kCoreSecondsPerFlownFrame = 0.069;
constexpr double kCoreSecondsPerCalibratedFrame = 0.044;
constexpr double kBytesPerFrame = 15'000;
constexpr double kBytesPerSequence = 580'000;  // preview.jpg
constexpr double kUsualPixels = 1280.0 * 960.0;

class Planner {
 public:
  explicit Planner(const catalogue::Catalogue& catalogue)
      : catalogue_(catalogue), facts_(catalogue.backgrounds.size()) {}

  void add(catalogue::Item& item) {
    const Facts& facts = facts_of(item.background);
    const catalogue::Draws draws = catalogue::draw_in_view(
        item, {.width = facts.width, .height = facts.height, .frame_rate_hz = facts.frame_rate_hz});
    plan_.draws += draws.drawn;
    plan_.never_in_view += draws.unseen;
    const std::int64_t frames = frames_of(item, facts);
    ++plan_.sequences;
    plan_.frames += frames;
    plan_.open_ended += frames == 0 ? 1 : 0;
    plan_.core_s += static_cast<double>(frames) * facts.size * kCoreSecondsPerFrame;
    plan_.bytes +=
        static_cast<double>(frames) * facts.size * kBytesPerFrame + kBytesPerSequence * facts.size;
    count_things(item.scene);
    for (const catalogue::Encounter& encounter : item.drawn.encounters) {
      if (encounter.size_px) plan_.sizes_px.add(*encounter.size_px);
      if (encounter.range_m) plan_.ranges_m.add(*encounter.range_m);
    }
    const double rate_hz = facts.frame_rate_hz > 0 ? facts.frame_rate_hz : 30;
    fly(item, frames > 0 ? static_cast<double>(frames - 1) / rate_hz : 1e9);
  }

  Plan result() { return std::move(plan_); }

 private:
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
    std::int64_t frames = 0;
    double frame_rate_hz = 0;
    // Pixels of a frame relative to 1280x960.
    double size = 1;
    int width = 0;
    int height = 0;
  };

  // Facts of a background in use; the first call also counts the cost of the background itself.
  const Facts& facts_of(std::size_t i) {
    if (facts_[i]) return *facts_[i];
    const catalogue::Background& background = catalogue_.backgrounds[i];
    const video::StreamInfo info = stream_of(background);
    Facts& facts = facts_[i].emplace(Facts{info.frame_count_estimate,
                                           info.frame_rate.value(),
                                           double(info.width) * info.height / kUsualPixels,
                                           info.width,
                                           info.height});
    const double whole = static_cast<double>(facts.frames) * facts.size;
    if (std::holds_alternative<synthetic::FlightOptions>(background.source))
      plan_.core_s += whole * kCoreSecondsPerFlownFrame;
    if (pipeline::needs_calibration(catalogue::scene_over(catalogue_, i))) {
      plan_.calibration_s += whole * kCoreSecondsPerCalibratedFrame;
      plan_.core_s += whole * kCoreSecondsPerCalibratedFrame;
    }
    return facts;
  }

  std::int64_t frames_of(const catalogue::Item& item, const Facts& facts) const {
    if (item.frame_count > 0) return item.frame_count;
    const std::int64_t first_frame = catalogue_.backgrounds[item.background].first_frame;
    return std::max<std::int64_t>(0, facts.frames - first_frame);
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

void Spread::add(double value) {
  // Number of values that are kept for the median: it bounds memory.
  constexpr std::size_t kMaxKept = 65'536;
  low_ = count_ == 0 ? value : std::min(low_, value);
  high_ = count_ == 0 ? value : std::max(high_, value);
  if (count_++ % every_ != 0) return;
  kept_.push_back(value);
  if (kept_.size() < kMaxKept) return;
  for (std::size_t i = 0; 2 * i < kept_.size(); ++i) kept_[i] = kept_[2 * i];
  kept_.resize(kMaxKept / 2);
  every_ *= 2;
}

double Spread::median() const {
  std::vector<double> sorted = kept_;
  const auto middle = sorted.begin() + std::ssize(sorted) / 2;
  std::nth_element(sorted.begin(), middle, sorted.end());
  return *middle;
}

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
