// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <fmt/format.h>

#include "labels/exchange/text.h"
#include "runners/results/results_files.h"

namespace airtruth::results {
namespace {

constexpr std::int64_t kMaxTrack = 1'000'000'000'000;

std::optional<std::int64_t> whole(double value, std::int64_t least, std::int64_t most) {
  const bool fits = value >= static_cast<double>(least) && value <= static_cast<double>(most) &&
                    value == std::floor(value);
  return fits ? std::optional(static_cast<std::int64_t>(value)) : std::nullopt;
}

}  // namespace

void read_mot_text(const fs::path& file, FrameList& frames) {
  for (const exchange::Line& line : exchange::lines_of(file)) {
    const Where where{file.string(), line.number};
    const std::vector<double> n = exchange::numbers_of(line, file);
    if (n.size() < 7 || n.size() > 10)
      throw Error(
          fmt::format("has {} columns; expected frame,id,left,top,width,height,score", n.size()),
          where);
    const auto frame = whole(n[0], 1, std::int64_t{1} << 40);
    if (!frame) throw Error("the frame is no whole number from 1 on", where);
    const auto track = whole(n[1], -1, kMaxTrack);
    if (!track) throw Error("the id is no whole number from -1 on", where);
    Detection detection;
    detection.box_px = {rounded_px(n[2] - 1), rounded_px(n[3] - 1), n[4], n[5]};
    detection.score = n[6];
    if (*track >= 0) detection.track = *track;
    frames.add(*frame - 1, std::move(detection), where);
  }
}

std::string mot_text_of(const SequenceDetections& detections) {
  std::string text;
  for (std::size_t i = 0; i < detections.frames.size(); ++i)
    for (const Detection& d : detections.frames[i])
      fmt::format_to(std::back_inserter(text),
                     "{},{},{},{},{},{},{:.9g},-1,-1,-1\n",
                     i + 1,
                     d.track.value_or(-1),
                     rounded_px(d.box_px.x + 1),
                     rounded_px(d.box_px.y + 1),
                     std::max(0.001, rounded_px(d.box_px.width)),
                     std::max(0.001, rounded_px(d.box_px.height)),
                     d.score);
  return text;
}

}  // namespace airtruth::results
