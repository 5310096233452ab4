// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <airtruth/box.h>

#include "camera/lens/lens.h"

// The truth that detections are scored against. A fact that is unknown is empty: an imported clip
// has no lens and often no ranges.
namespace airtruth::scores {

// One object in one frame.
struct TruthObject {
  // The same number for the same object throughout a sequence, from 0; TruthSequence::encounters
  // has its encounter.
  std::int64_t id = 0;
  // IntruderTruth::object_class in <airtruth/truth.h>: an "aircraft" is to be found, all others are
  // not. A detection on one of them is a false alarm that is named by this class.
  std::string object_class = "aircraft";
  // Type of the aircraft.
  std::string category;
  Box box_px;
  // Area of its pixels where the set states it, else of its box (exchange::Label::area_px).
  double area_px = 0;
  // False for an aircraft that is neither missed nor found: one that is in the picture, but too
  // faint to have a covered box. Detections on it count neither way.
  bool counts = true;
  std::optional<double> range_m;
  // Contrast of the box to its surroundings over their noise (contrast_to_noise.h); known where the
  // video was read.
  std::optional<double> contrast_to_noise;
  std::optional<bool> above_horizon;
  // Bearing of the aircraft's reference point in the camera of this frame, right and up positive.
  std::optional<double> azimuth_deg;
  std::optional<double> elevation_deg;
  // From this frame; negative after the closest approach.
  std::optional<double> to_closest_approach_s;

  bool is_aircraft() const { return object_class == "aircraft"; }
  // The longer side of the box.
  double size_px() const { return box_px.width > box_px.height ? box_px.width : box_px.height; }
};

struct TruthFrame {
  // Number of the frame in the video.
  std::int64_t frame = 0;
  // Seconds from the first frame of the sequence.
  double time_s = 0;
  std::vector<TruthObject> objects;
  // Regions in which detections count neither way: unlabelled aircraft of the background.
  std::vector<Box> ignored_px;
  // Of an imported clip: the number of the frame's picture in its set.
  std::optional<std::int64_t> image_id;
};

// What is known of the encounter with one aircraft.
struct TruthEncounter {
  std::int64_t id = 0;  // TruthObject::id
  std::string name;     // id of the intruder in the scene, or the number of its track
  // Clock of TruthFrame::time_s. May lie after the last frame.
  std::optional<double> closest_approach_s;
  std::optional<double> closest_approach_m;
  // The first time at which the aircraft violates the volume that was asked for; empty where it
  // never does.
  std::optional<double> violation_s;
  // False where nothing is known of the volume: truth without positions.
  bool has_volume = false;
};

struct TruthSequence {
  std::string name;
  // labelled::ClipFacts::background_name.
  std::string background;
  // The name of the background's file, by which ignored regions may name it.
  std::string background_file;
  // The frame of that file that became the sequence's first.
  std::int64_t first_background_frame = 0;
  // The same for sequences over the same frames of one background; empty for an imported clip.
  std::string background_cut;
  // The video that detectors see; may be empty for an imported clip.
  std::filesystem::path media;
  int width = 0;  // px; 0: unknown
  int height = 0;
  double frame_rate_hz = 0;
  // False for an imported clip that states neither its rate nor the times of all its frames.
  bool has_times = true;
  // Number of frames over the frame rate, or the span of the time stamps with one frame more.
  double duration_s = 0;
  std::optional<lens::Lens> lens;
  // What is known of the weather of what was inserted (scene::weather_facts()).
  std::map<std::string, double> weather;
  // Of the encounter among those of its encounter model; empty where the set has none: it counts as
  // 1.
  std::optional<double> weight;
  std::vector<TruthFrame> frames;
  std::vector<TruthEncounter> encounters;  // one for each aircraft that any frame shows
  // Number of intruders that no frame shows. No measure holds them: no detector could find them.
  std::int64_t never_seen = 0;
  // labelled::LabelledSet::sha256_of() of it.
  std::string sha256;
  // The classes (TruthObject::object_class) of the categories that the set's objects have.
  std::map<std::string, std::string> class_of;

  const TruthEncounter* encounter(std::int64_t id) const {
    for (const TruthEncounter& one : encounters)
      if (one.id == id) return &one;
    return nullptr;
  }
};

}  // namespace airtruth::scores
