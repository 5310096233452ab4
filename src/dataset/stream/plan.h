// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <variant>
#include <vector>

#include "dataset/catalogue/catalogue.h"
#include "dataset/catalogue/expand.h"
#include "foundation/base/seed.h"
#include "scene/scene/scene.h"

// What each sample of a stream is of: its scene, before a frame is read.
//
// Eight runs of consecutive frames, the lanes, take turns. A lane makes `reuse` samples of one
// frame before it goes on to the next, and begins another run, of another background or place,
// after kRunFrames frames. So samples in a row are of eight places, and each decoded frame is used
// often. What is put there is drawn for each sample by itself.
//
// Example: reuse = 8. Samples 0, 8, .., 56 are of the first frame of run 0, samples 1, 9, .., 57 of
// the first frame of run 1; sample 64 is of the second frame of run 0.
namespace airtruth::stream {

inline constexpr std::int64_t kLanes = 8;  // chosen
// Chosen: the frames between a key frame and a run's first frame are decoded in vain, some 125 of
// the usual 250 between key frames.
inline constexpr std::int64_t kRunFrames = 16;

struct Place {
  std::int64_t run = 0;
  // Of the run's frames, 0 to kRunFrames - 1.
  std::int64_t step = 0;
  // Of the samples of the same run, which count on through all its frames.
  std::int64_t sample_of_run = 0;
};

Place place_of(std::int64_t index, std::int64_t reuse);

// The scene of a sample, and the run of frames that it belongs to (Place).
struct Planned {
  scene::Scene scene;
  std::size_t background = 0;
  std::int64_t run = 0;  // a number of its own for each part of a run
};

// A sample of [[random]] is a sequence of the rule that is as long as the sample; its meeting
// moment lies within. Of an encounter, by [random.encounter] or [[encounter_model]], it is a part
// of the sequence: one that shows the intruder, where there is one.
class Planner {
 public:
  // `files` gives the files of a background by its place in the catalogue, and `shared` the
  // aircraft. Throws Error for what a stream cannot draw: rules that list their sequences, paths by
  // what is seen, and cameras whose path belongs to the first frame.
  Planner(const catalogue::Catalogue& catalogue,
          std::uint64_t seed,
          std::function<const catalogue::BackgroundFiles&(std::size_t)> files,
          setup::SharedInputs& shared);

  // Throws Error where the background or an aircraft cannot be read.
  Planned at(std::int64_t index) const;

 private:
  using Drawing = std::variant<catalogue::Drawn, catalogue::EncounterRule>;
  // The types of one rule or several, of which a few fly at a time.
  struct Fleet {
    std::vector<catalogue::AircraftType> types;
    bool every_type = false;  // at least one of each type at a time
    std::uint64_t seed = 1;
  };
  // A rule without its types, which are those of a fleet.
  struct Rule {
    Drawing drawing;
    std::size_t fleet = 0;
    std::uint64_t seed = 1;
  };
  // The frames that a run of samples is over.
  struct Run {
    std::size_t background = 0;
    std::int64_t first_frame = 0;  // in the video
    std::int64_t frames = 1;       // at which a sample may begin
  };

  Drawing checked(const catalogue::Rule& rule) const;
  // The number of the fleet of these types, which is new if no rule before has it.
  std::size_t fleet_with(Fleet fleet);
  std::size_t aircraft_at_a_time(const Fleet& fleet) const;
  std::vector<catalogue::AircraftType> flying(const Fleet& fleet, std::int64_t index) const;
  void check_backgrounds(const std::vector<std::size_t>& places) const;
  // Any rule as often as it has sequences, where `share` is 1 for all.
  const Rule& drawn_rule(Random random, const std::function<double(const Rule&)>& share) const;
  // Of several parts where the background of the first is shorter than a run.
  Run run_of(std::int64_t number, std::int64_t part) const;
  // Of a sample over that background.
  const Rule& rule_over(std::size_t background, std::int64_t index) const;
  scene::Scene scene_of(const Rule& rule,
                        const catalogue::StreamPlace& place,
                        std::int64_t index) const;
  void keep_part_in_view(catalogue::Item& item, Random random) const;

  const catalogue::Catalogue& catalogue_;
  std::uint64_t seed_;
  std::function<const catalogue::BackgroundFiles&(std::size_t)> files_;
  setup::SharedInputs& shared_;
  std::vector<Fleet> fleets_;
  std::vector<Rule> rules_;
  // For how many samples an aircraft of a fleet flies.
  std::int64_t samples_of_aircraft_ = 1;
};

}  // namespace airtruth::stream
