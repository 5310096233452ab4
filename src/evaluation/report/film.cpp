// SPDX-License-Identifier: Apache-2.0
#include "evaluation/report/film.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "foundation/base/error.h"
#include "foundation/base/text.h"
#include "foundation/image/colour.h"
#include "picture/video/still.h"
#include "show/drawing/thumbnails.h"

namespace airtruth::report {

Cutout cutout_of(const image::Picture& picture, const Box& box, const CutoutOptions& options) {
  Cutout cutout;
  const double largest = options.most_of_picture * std::max(picture.width, picture.height);
  cutout.px = std::clamp(std::round(options.surroundings * std::max(box.width, box.height)),
                         options.least_px,
                         largest);
  cutout.x = std::round(box.x + box.width / 2 - cutout.px / 2);
  cutout.y = std::round(box.y + box.height / 2 - cutout.px / 2);
  cutout.x = std::clamp(cutout.x, -cutout.px, static_cast<double>(picture.width));
  cutout.y = std::clamp(cutout.y, -cutout.px, static_cast<double>(picture.height));
  cutout.jpeg = video::jpeg_of(
      drawing::square(picture, cutout.x, cutout.y, cutout.px, options.side), options.quality);
  return cutout;
}

Still still_of(const image::Picture& picture,
               std::size_t index,
               const std::optional<Box>& subject,
               const CutoutOptions& options) {
  Still still{.index = index, .width = picture.width};
  still.whole = video::jpeg_of(
      drawing::small_copy(image::rgb8_from_picture(picture), options.whole_width), options.quality);
  if (subject) still.close = cutout_of(picture, *subject, options);
  return still;
}

const image::Picture& ClipPictures::at(std::int64_t frame) {
  if (stop_.stop_requested()) throw Interrupted();
  const image::Picture* picture = frames_.at(frame);
  if (picture == nullptr)
    throw Error("ends before the labels of " + name_ + " do", {media_.string()});
  return *picture;
}

std::set<std::size_t> spread_over(std::size_t frames, std::size_t count) {
  std::set<std::size_t> indices;
  const std::size_t most = std::min(frames, count);
  for (std::size_t n = 0; n < most; ++n)
    indices.insert(most > 1 ? n * (frames - 1) / (most - 1) : 0);
  return indices;
}

void add_picture(std::vector<html::PageBlob>& pictures,
                 const std::string& name,
                 const std::string& jpeg) {
  if (!jpeg.empty()) pictures.push_back({name, base64_of(jpeg)});
}

void add_stills(std::vector<html::PageBlob>& pictures,
                std::size_t sequence,
                const std::vector<Still>& stills) {
  for (std::size_t i = 0; i < stills.size(); ++i) {
    add_picture(pictures, fmt::format("whole-{}-{}", sequence, i), stills[i].whole);
    add_picture(pictures, fmt::format("close-{}-{}", sequence, i), stills[i].close.jpeg);
  }
}

}  // namespace airtruth::report
