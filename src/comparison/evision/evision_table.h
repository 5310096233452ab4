// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "foundation/base/files.h"
#include "foundation/base/log.h"
#include "foundation/geometry/box.h"
#include "foundation/geometry/transform.h"

// The published E-Vision annotations against boxes of our own making (docs/evision.md).
//
// Their virtual camera is a pinhole of 480 px focal length on 1280x960 that looks north, level.
// Each sequence's intruder goes through its published positions along its path, an airliner where
// the sequence's name ends in B737 and a light aircraft where it ends in C172. Ours is the box of
// the pixels that it covers by 0.3 or more, as a colour key would take them.
//
// The published boxes were measured on pictures that the camera's motion had moved and that two
// Lanczos warps had spread. The motion is not published. Sequences over one background share it
// frame by frame, so it is taken from the centres of their boxes; widths and heights have no part
// in it.
namespace airtruth::evision {

// One frame of one sequence.
struct EvisionFramePair {
  std::string sequence;
  int frame = 0;  // from 1, as in the files
  std::optional<PixelBox> ours;
  PixelBox published;  // all zero: none
};

struct EvisionOptions {
  std::string airliner = "733/733-AirBaltic";
  std::string light_aircraft = "c172/news";
  // Pixels that a warp adds to each side of a box; the first frame is not warped.
  int spread_px = 3;
  // Recovers the motion from the centres of the boxes of all sequences over one background
  // (motion_from_sightings()).
  bool recover_motion = true;
  // True: the aircraft banks as in a coordinated turn along its path; false: its wings stay level.
  bool bank = true;
  double scale = 1;                                   // scale of the aircraft
  std::function<void(const EvisionFramePair&)> each;  // called for every compared frame
  std::stop_token stop;
};

// Of a frame that has both boxes; of a sequence, the medians over its compared frames.
struct EvisionOffsets {
  double published_width_px = 0;
  double published_height_px = 0;
  double width_off_px = 0;  // of |ours - published|
  double height_off_px = 0;
  double width_off = 0;  // of |ours - published| / published
  double height_off = 0;
  double centre_off_px = 0;  // distance of the centres
};

struct EvisionRow : EvisionOffsets {
  std::string sequence;
  int frames = 0;  // frames with a defined intruder position
  // Number of these frames with a published box that is not empty.
  int published_boxes = 0;
  // Frames with both boxes, of which neither is cut by the frame.
  int compared = 0;
  // Frames in which the whole aircraft is in the picture and the published box is empty.
  int without_box_published = 0;
  // Frames in which the centre of its outline is in the picture and this program's box is empty.
  int without_box_ours = 0;
  double centre_off_p95_px = 0;

  // Within 2 px or 10 % in the median.
  bool sizes_hold() const {
    return (width_off_px <= 2 || width_off <= 0.1) && (height_off_px <= 2 || height_off <= 0.1);
  }
};

// One row per file of folder/groundtruth/*.xml, by name; positions from folder/positions/<same
// name>.csv. Throws Error where a file is missing or not of its format.
std::vector<EvisionRow> evision_table(const fs::path& folder,
                                      const EvisionOptions& options,
                                      const Warn& warn = {});

// The position of an intruder without the camera's motion, and the position at which it was found.
struct Sighting {
  Pixel still_px;
  Pixel found_px;
};

// Returns the homography of one frame from the sightings in that frame, over all the sequences that
// share a background. It has four parameters: a shift (two), a roll, and a drift s. The drift
// models what the paper's homographies accumulate while the aircraft flies on over the ground that
// they follow, which draws everything above the horizon towards the horizon. With y down from the
// horizon and s the distance flown divided by the height,
//
//   x' = x / (1 - s y),  y' = y / (1 - s y)
//
// The parameters are found by least squares (Gauss-Newton). Roll and s are held near 0 by 0.1 each,
// so that one sighting gives a shift. `principal_point_px` lies on the horizon, because the nominal
// camera is level. Returns the identity without a sighting.
Homography motion_from_sightings(const std::vector<Sighting>& sightings,
                                 const Pixel& principal_point_px,
                                 double focal_px);

}  // namespace airtruth::evision
