// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "camera/lens/lens.h"
#include "dataset/catalogue/drawn_rule.h"
#include "encounter/pairing/pair.h"
#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "scene/scene/scene.h"
#include "scene/scene/table_reader.h"

// The tables [[encounter_model]] of a catalogue and their encounters. Each encounter depends on the
// rule and its index alone.
namespace airtruth::encounter_model {
class Sampler;
}

namespace airtruth::catalogue {

struct Catalogue;

// A rule for encounters: intruders that pass the own aircraft as a model of traffic or a stated
// geometry says (encounter/pairing/pair.h). A type whose class flies the intruder's track is
// chosen, then a livery of it.
struct EncounterRule : NumberedRule {
  // The seed of all that is drawn; it follows from the catalogue's and the rule's name.
  std::uint64_t seed = 1;
  // The tracks of `kind = "bayes"` and their file; empty: the geometry below is drawn.
  std::shared_ptr<const encounter_model::Sampler> tracks;
  fs::path model_file;
  // Times are those of the clip. Tracks of a model use only the time and the miss distances.
  pairing::GeometricOptions geometry;
  // How long the tracks are, in seconds of the clip.
  int length_s = 0;
  // Share of the sequences with an intruder that have two, from 0 to 1.
  double two_intruders = 0;
  // True: an intruder is drawn again until its reference point is in the view of the nominal camera
  // for `seen_s` in all.
  bool in_view = true;
  double seen_s = 1;
  // False: the speed of a geometry is a usual one of the type.
  bool states_speed = false;
};

// What the camera of a background looks through, and when.
struct Views {
  lens::Lens lens;
  std::int64_t frames = 0;
  double frame_rate_hz = 0;
};

// The frames in which the reference point of an intruder is in the view; of a clip of more than a
// few thousand every few of them are looked at.
std::vector<std::int64_t> frames_in_view(const scene::Intruder& intruder,
                                         const scene::Camera& camera,
                                         const Views& views);

// How often the intruders of a sequence were drawn.
struct Draws {
  std::int64_t drawn = 0;
  // Intruders that no draw brought into view; the draw that brought them there longest is kept.
  std::int64_t unseen = 0;
};

// Encounters are drawn before the frame rate of a video is known, for clips of this rate or more.
constexpr double kSlowestRateHz = 24;

// Where a data set keeps the model of a rule, below its folder.
fs::path kept_model(const fs::path& folder, const fs::path& model_file);

// Reads the tables [[encounter_model]] of a catalogue whose seed and backgrounds have been read,
// and the models that they name: a file beside the catalogue, or where the catalogue is the copy in
// a data set, the copy there. Throws Error with line and column.
std::vector<EncounterRule> encounter_rules(const scene::TableReader& root,
                                           const Catalogue& catalogue);

// The aircraft of the first intruder of sequence `index` where its type flies the track that is
// drawn first.
std::string likely_aircraft(const EncounterRule& rule, std::int64_t index);

// Gives the scene, whose camera is the own aircraft, the intruders of sequence `index` and, where
// they come from a model, its weight, of two intruders the product over the mean weight of one. A
// negative sequence gets none. Types are taken evenly in turn where their class flies the track,
// else one that does, at its usual speed where there is one. By a rule of in_view an intruder is
// drawn again where the camera does not see it, at most kMostDraws times. Where the own aircraft is
// higher than kLowestFlightM, so is every intruder.
//
// A track that is too low, or of a model one that no aircraft of the rule flies, is drawn again; a
// model's closest approach falls on a whole second. Throws Error at the rule where no draw of many
// is possible, or where the camera's path ends before the closest approach.
Draws add_encounter(scene::Scene& scene,
                    const EncounterRule& rule,
                    std::int64_t index,
                    const Views& views);

constexpr std::uint64_t kMostDraws = 200;  // chosen

}  // namespace airtruth::catalogue
