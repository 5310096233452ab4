// SPDX-License-Identifier: Apache-2.0
#include "dataset/stream/stream.h"

#include <algorithm>
#include <utility>

#include <airtruth/stream.h>

#include "dataset/catalogue/catalogue.h"
#include "library/pictures/public_forms.h"

namespace airtruth {

struct Stream::State {
  stream::Stream stream;
};

Stream::Stream(std::unique_ptr<State> state) : state_(std::move(state)) {}

Stream::Stream(const std::filesystem::path& catalogue_file, const StreamOptions& options)
    : Stream(std::unique_ptr<State>(new State{stream::Stream(
          catalogue::read_catalogue(catalogue_file), options.seed, run_options(options))})) {}

Stream Stream::from_text(std::string_view catalogue,
                         const std::filesystem::path& folder,
                         const StreamOptions& options) {
  return Stream(std::unique_ptr<State>(
      new State{stream::Stream(catalogue::parse_catalogue(catalogue, folder / "catalogue"),
                               options.seed,
                               run_options(options))}));
}

Stream::~Stream() = default;
Stream::Stream(Stream&&) noexcept = default;
Stream& Stream::operator=(Stream&&) noexcept = default;

StreamSample Stream::sample(std::int64_t index) const {
  stream::Sample made = state_->stream.sample(index);
  StreamSample sample{index, made.background, made.first_frame, made.weight, made.crop, {}, {}, {}};
  for (stream::Sample::Frame& frame : made.frames) {
    sample.frames.push_back({public_picture(frame.picture), std::move(frame.truth)});
    sample.covered.push_back(std::move(frame.covered));
    if (!state_->stream.has_masks()) continue;
    std::vector<SamplePlane>& masks = sample.masks.emplace_back();
    for (std::vector<std::uint8_t>& mask : frame.masks)
      masks.push_back({made.crop.width, made.crop.height, std::move(mask)});
  }
  return sample;
}

std::string Stream::scene(std::int64_t index) const {
  return scene::toml_from_scene(state_->stream.scene(index));
}

std::optional<Box> in_crop(const Box& box_px, const PixelBox& crop) {
  const double x0 = std::max(box_px.x - crop.x, 0.0);
  const double y0 = std::max(box_px.y - crop.y, 0.0);
  const double x1 = std::min(box_px.x + box_px.width - crop.x, double(crop.width));
  const double y1 = std::min(box_px.y + box_px.height - crop.y, double(crop.height));
  if (!(x1 > x0 && y1 > y0)) return std::nullopt;
  return Box{x0, y0, x1 - x0, y1 - y0};
}

}  // namespace airtruth
