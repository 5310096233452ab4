// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "dataset/catalogue/catalogue.h"
#include "dataset/catalogue/distractors.h"
#include "dataset/catalogue/drawing.h"

namespace airtruth::catalogue {

// The files of a background on this machine, and the facts of its video.
struct BackgroundFiles {
  fs::path video;
  std::optional<fs::path> mask;
  int width = 0;
  int height = 0;
  double pixel_aspect = 1;   // width over height of a pixel
  double frame_rate_hz = 0;  // 0: unknown
  // To the end of what the background uses, counted from the video's first frame; 0: unknown.
  std::int64_t frames = 0;
  // Of a background with a flight log: its camera with the time of first_frame on the video's clock
  // and, where neither the scene nor the log states an attitude, a level one.
  std::optional<scene::Camera> camera;
  // When each of the frames is shown, from the first on, where the rate varies; else empty.
  std::vector<double> times_s;
};

// One sequence of a catalogue.
struct Item {
  std::int64_t index = 0;
  std::string name;
  Where where;  // of the table that makes it
  std::size_t background = 0;
  std::int64_t frame_count = 0;
  // place() fills in [background]. Until then the paths of random intruders are provisional.
  scene::Scene scene;
  const Drawn* rule = nullptr;  // the rule of [[random]]; nullptr for a listed sequence
  DrawnSequence drawn;          // valid where there is a rule
  // In place of the background's first_frame, and of a random one.
  std::optional<std::int64_t> first_frame;
  // True where the clip begins at a drawn frame of its background.
  bool has_random_start() const { return rule != nullptr && rule->starts_at_random; }
  // In the scene already, with provisional places until place().
  DrawnDistractors distractors;
  // Of a sequence of [[encounter_model]]: its rule, and its number there. It has no aircraft until
  // place(), since they pass the camera's path, whose files a copy of the catalogue need not have.
  const EncounterRule* encounter_rule = nullptr;
  std::int64_t index_in_rule = 0;
};

// The sequences of a catalogue by number, in the order of the file. Memory holds only the catalogue
// and does not grow with the number of sequences. Item i depends on the catalogue and i alone.
class Expansion {
 public:
  // Throws Error for more than kMostSequences.
  explicit Expansion(const Catalogue& catalogue);
  std::int64_t size() const { return size_; }
  Item at(std::int64_t index) const;

 private:
  const Catalogue& catalogue_;
  std::vector<std::int64_t> first_;  // index of the first item of each rule
  std::int64_t size_ = 0;
};

// An item of a rule that has no end: where it lies is stated, and `seed` decides all else.
struct StreamPlace {
  std::size_t background = 0;
  std::int64_t first_frame = 0;
  // Of the item in its rule. Every `count` of them from the first on are stratified as the rule's
  // sequences.
  std::int64_t index = 0;
};
Item stream_item(const Catalogue& catalogue,
                 const Drawn& rule,
                 const StreamPlace& place,
                 std::uint64_t seed);

// The intruders are drawn by place(), by the rule's own seed, which should be another after each
// count of the rule. `seed` decides the distractors.
Item stream_item(const Catalogue& catalogue,
                 const EncounterRule& rule,
                 const StreamPlace& place,
                 std::uint64_t seed);

// Makes a scene over the background with this index in the catalogue. It lacks [background],
// intruders and name.
scene::Scene scene_over(const Catalogue& catalogue, std::size_t background);

// The clip of so many frames (0: all) from one of the background's on, or fewer where the
// background ends; 0: of an unknown number.
DrawnClip clip_over(const BackgroundFiles& files, std::int64_t first_frame, std::int64_t frames);

// Gives an item's scene the camera and the pixels' shape of its background, and draws the intruders
// of a sequence of [[encounter_model]] for the size, rate and number of the background's pictures,
// which `files` states.
Draws draw_in_view(Item& item, const Catalogue& catalogue, const BackgroundFiles& files);

// Gives an item's scene the files of its background, and gives random values their place in time
// and space: the first frame, the meeting moment, and the range at which an aircraft has the
// requested size. Throws Error at the rule where no range gives that size (the direction is outside
// the lens's field), and where a random start is requested in a video that does not state its
// length. `shared` gives the aircraft where it is not nullptr.
void place(Item& item,
           const Catalogue& catalogue,
           const BackgroundFiles& files,
           setup::SharedInputs* shared = nullptr);

}  // namespace airtruth::catalogue
