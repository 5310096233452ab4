// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "dataset/labelled/labelled_set.h"
#include "dataset/set_report/encounters.h"
#include "dataset/set_report/film.h"
#include "scene/scene/scene.h"

namespace airtruth::set_report {

// The content of the report page for one sequence, read from its record, its truth and its video.
// Series are thinned to at most kMaxPoints points.
struct Portrait {
  // Number of points of a series: a display choice.
  static constexpr std::size_t kMaxPoints = 120;
  // The grid of cells over the picture in which the centres of boxes are counted.
  static constexpr int kCellColumns = 32;
  static constexpr int kCellRows = 24;

  // One intruder in one frame.
  struct Point {
    std::int64_t frame = 0;
    double time_s = 0;
    std::optional<double> range_m, azimuth_deg;
    // Negative after the closest approach; empty where the sequence has no record of it.
    std::optional<double> to_closest_s;
    std::optional<std::array<double, 3>> position_ned_m;
    // Size of the covered box, or of the visible box where there is no covered one.
    std::optional<double> width_px, height_px;
    const char* state = "";
  };
  struct Intruder {
    std::string id;
    std::string aircraft;
    std::string object_class;  // labels/annotation/object_class.h
    std::vector<Point> points;
  };
  struct Camera {
    std::int64_t frame = 0;
    std::array<double, 3> position_ned_m{};
    double yaw_deg = 0;
    // Displacement of the picture's centre by the measured camera motion.
    double shift_px = 0;
    double roll_deg = 0;
  };

  labelled::ClipFacts facts;
  std::string folder;              // the folder of the sequence's files
  std::vector<std::string> files;  // file names in `folder`
  int width = 0, height = 0;
  double duration_s = 0;
  std::optional<double> horizontal_fov_deg;
  std::optional<scene::Scene> scene;  // the effective scene; empty for an imported clip
  std::vector<Intruder> intruders;
  std::vector<Camera> camera;
  // In the order of the scene; empty for an imported clip and an older sequence.
  std::vector<Encountered> encounters;
  // Frames of aircraft with the state visible, hidden, outside, behind and ended, in this order.
  std::array<std::int64_t, 5> frames_by_state{};
  // Number of these visible states that have a covered box.
  std::int64_t covered_boxes = 0;
  // Number of states that are in view by geometry and have no box (labels/annotation/lens_facts.h).
  std::int64_t without_box = 0;
  // Frames for which a label describes an aircraft.
  std::int64_t frames_with_intruder = 0;
  std::map<std::string, std::int64_t> boxes_by_class;
  // Number of box centres in each cell, row by row from the top.
  std::vector<std::int64_t> centres;
  // The ids of all intruders (replay::intruder_ids).
  std::vector<std::string> ids;
  Film film;
  // Empty where the pictures are separate files.
  std::filesystem::path video;
};

// `stills` is the highest number of pictures in its film; 0: no film, and no frame is decoded.
Portrait portrait_of(const labelled::LabelledSet& set,
                     const std::string& name,
                     std::size_t stills,
                     const std::stop_token& stop);

}  // namespace airtruth::set_report
