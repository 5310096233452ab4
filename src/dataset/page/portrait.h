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
#include "dataset/page/film.h"
#include "world/scene/scene.h"

namespace airtruth::dataset {

// What the report page shows of one sequence, read from its record, its truth and its video.
// Series are thinned to at most kMostPoints.
struct Portrait {
  static constexpr std::size_t kMostPoints = 120;
  // Cells of the picture in which the centres of boxes are counted.
  static constexpr int kCellColumns = 32;
  static constexpr int kCellRows = 24;

  struct Point {  // of one intruder in one frame
    std::int64_t frame = 0;
    double time_s = 0;
    std::optional<double> range_m, azimuth_deg, elevation_deg;
    std::optional<std::array<double, 3>> position_ned_m;
    std::optional<double> width_px, height_px;  // of its covered (else visible) box
    const char* state = "";
  };
  struct Intruder {
    std::string id;
    std::string aircraft;
    std::vector<Point> points;
  };
  struct Camera {
    std::int64_t frame = 0;
    std::array<double, 3> position_ned_m{};
    double yaw_deg = 0;
    double shift_px = 0;  // of the picture's middle, by the measured motion
    double roll_deg = 0;
  };

  ClipFacts facts;
  std::string folder;              // of its files
  std::vector<std::string> files;  // in it
  int width = 0, height = 0;
  double duration_s = 0;
  std::optional<double> horizontal_fov_deg;
  std::optional<double> sun_azimuth_deg, sun_elevation_deg;
  std::string motion_model;
  std::optional<scene::Scene> scene;  // the effective one; empty: imported
  std::vector<Intruder> intruders;
  std::vector<Camera> camera;
  std::array<std::int64_t, 5> frames_by_state{};  // visible, hidden, outside, behind, ended
  std::int64_t covered_boxes = 0;                 // of the visible ones
  std::int64_t without_box = 0;           // in view by geometry (truth/annotation/in_view.h)
  std::int64_t frames_with_intruder = 0;  // that a label says something of
  std::map<std::string, std::int64_t> boxes_by_class;
  std::vector<std::int64_t> centres;  // of boxes by cell of the picture, row by row from the top
  std::vector<std::string> ids;       // of all intruders (sequence::intruder_ids)
  Film film;
  std::filesystem::path video;  // empty where the pictures are files of their own
};

// `stills`: pictures in its film at most.
Portrait portrait_of(const LabelledSet& set,
                     const std::string& name,
                     std::size_t stills,
                     const std::stop_token& stop);

}  // namespace airtruth::dataset
