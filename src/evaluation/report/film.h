// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "foundation/image/picture.h"
#include "picture/video/numbered_frames.h"
#include "show/drawing/thumbnails.h"
#include "show/html/page.h"

// The film of a page: small pictures of a clip's frames.
namespace airtruth::report {

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

// Adds the stills of the sequence with this number, under the names by which a page finds them.
void add_stills(std::vector<html::PagePicture>& pictures,
                std::size_t sequence,
                const std::vector<drawing::Still>& stills);

}  // namespace airtruth::report
