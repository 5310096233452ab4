// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <set>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include <airtruth/box.h>

#include "foundation/image/picture.h"
#include "picture/video/numbered_frames.h"
#include "show/html/page.h"

// The film of a page: small pictures of a data set's frames.
namespace airtruth::report {

// A square cut out of a frame, as a JPEG.
struct Cutout {
  std::string jpeg;
  // The square in the frame, px.
  double x = 0, y = 0, px = 0;
};

struct CutoutOptions {
  // Side of the square in the frame as a multiple of the box's longer side, and its least side.
  double surroundings = 4;
  double least_px = 48;
  // Its largest side as a multiple of the longer side of the picture.
  double most_of_picture = 2;
  int side = 160;         // of the JPEG, px
  int whole_width = 480;  // of a still's whole picture, px
  int quality = 7;        // of libav's mjpeg encoder
};

// The surroundings of a box. A box may lie anywhere; a square far from the picture is black.
Cutout cutout_of(const image::Picture& picture, const Box& box, const CutoutOptions& options);

// A frame on a page, as JPEGs.
struct Still {
  std::size_t index = 0;  // of the frame in its sequence
  int width = 0;          // of the video's picture, px
  // The whole picture, at most CutoutOptions::whole_width pixels wide.
  std::string whole;
  // The surroundings of its subject; empty without one.
  Cutout close;
};
Still still_of(const image::Picture& picture,
               std::size_t index,
               const std::optional<Box>& subject,
               const CutoutOptions& options);

// The pictures of a clip, in order.
class ClipPictures {
 public:
  // `name` is that of the clip, for messages.
  ClipPictures(const std::filesystem::path& media, const std::string& name, std::stop_token stop)
      : media_(media), name_(name), stop_(std::move(stop)), frames_(media, {}) {}
  // The picture of a frame of the video, valid until the next call. Throws Error where the video
  // ends before, and Interrupted.
  const image::Picture& at(std::int64_t frame);

 private:
  std::filesystem::path media_;
  std::string name_;
  std::stop_token stop_;
  video::NumberedFrames frames_;
};

// Indices of `count` of `frames` frames, spread evenly from the first to the last.
std::set<std::size_t> spread_over(std::size_t frames, std::size_t count);

// Adds a picture under the name by which the page finds it; one without content is left out.
void add_picture(std::vector<html::PageBlob>& pictures,
                 const std::string& name,
                 const std::string& jpeg);
// Adds the stills of the sequence with this number.
void add_stills(std::vector<html::PageBlob>& pictures,
                std::size_t sequence,
                const std::vector<Still>& stills);

}  // namespace airtruth::report
