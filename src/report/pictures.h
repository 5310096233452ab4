// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "annotation/truth.h"
#include "image/layer.h"
#include "image/picture.h"

// Pictures for people: the contact sheet, the burnt-in overlay, the close look at one frame.
namespace airtruth::report {

// preview.jpg: up to twelve frames, each with the intruder enlarged in a corner, its range and its frame number.
// Feed frames as they come; keeps small copies of the chosen ones alone.
class ContactSheet {
 public:
  // Chooses `tiles` frames evenly among `frame_count` (or the first that show an intruder where few do).
  ContactSheet(std::string title, std::int64_t frame_count_estimate, int tiles = 12);
  void add(const image::Picture& picture, const annotation::Frame& truth);
  image::Rgb8 sheet() const;

 private:
  struct Tile {
    image::Rgb8 small;
    std::vector<image::Rgb8> closeups;
    std::string caption;
  };
  std::string title_;
  std::int64_t every_ = 1;
  int tiles_ = 12;
  std::vector<Tile> chosen_;
};

// Burns boxes, id and range into a copy of a picture (the look of the paper's Figure 12).
image::Rgb8 overlay(const image::Picture& picture, const annotation::Frame& truth);

// Background, alpha and result of one intruder side by side, nearest-neighbour enlarged `zoom` times, boxes drawn.
image::Rgb8 closeup(const image::Picture& background, const image::Picture& result, const image::Layer* layer,
                    const annotation::Frame& truth, std::size_t intruder, int zoom);

}  // namespace airtruth::report
