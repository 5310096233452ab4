// SPDX-License-Identifier: Apache-2.0
#include "runners/results/detections.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include <fmt/format.h>

#include "foundation/geometry/box.h"

namespace airtruth::results {
namespace {

// 4.6 hours at 30 frames/s; a larger number is taken for an error in its file.
constexpr std::int64_t kMaxFrames = 500'000;
// A frame with more is taken for an error of the detector.
constexpr std::size_t kMaxPerFrame = 100'000;

std::string text_of(const Box& box) {
  return fmt::format("{:.6g},{:.6g} {:.6g}x{:.6g}", box.x, box.y, box.width, box.height);
}

}  // namespace

bool is_sound(const Box& box) {
  return is_finite(box) && box.width > 0 && box.height > 0 && std::isfinite(box.area());
}

void sort_by_score(std::vector<Detection>& detections) {
  std::ranges::stable_sort(detections, std::greater(), &Detection::score);
}

std::optional<std::string> fault_of(const Detection& detection, int width, int height) {
  const Box& box = detection.box_px;
  if (!std::isfinite(detection.score))
    return fmt::format("a score is {}; expected a finite number", detection.score);
  if (!is_finite(box)) return "a box holds a number that is not finite";
  if (!(box.width > 0) || !(box.height > 0))
    return fmt::format("the box {} has no area", text_of(box));
  if (width > 0 &&
      (!(box.x < width) || !(box.y < height) || !(box.right() > 0) || !(box.bottom() > 0)))
    return fmt::format("the box {} lies outside its image of {}x{}", text_of(box), width, height);
  return std::nullopt;
}

FrameList::FrameList(std::string name, int width, int height, std::int64_t frames)
    : grows_(frames == 0) {
  found_.name = std::move(name);
  found_.width = width;
  found_.height = height;
  found_.frames.resize(static_cast<std::size_t>(frames));
}

void FrameList::add(std::int64_t frame, Detection detection, const Where& where) {
  if (const auto fault = fault_of(detection, found_.width, found_.height))
    throw Error(*fault, where);
  const std::int64_t last = grows_ ? kMaxFrames : std::ssize(found_.frames);
  if (frame < 0 || frame >= last)
    throw Error(
        fmt::format(
            "the frame is number {} of '{}'; expected 1 to {}", frame + 1, found_.name, last),
        where);
  if (frame >= std::ssize(found_.frames)) found_.frames.resize(static_cast<std::size_t>(frame) + 1);
  auto& list = found_.frames[static_cast<std::size_t>(frame)];
  if (list.size() >= kMaxPerFrame)
    throw Error(
        fmt::format(
            "frame {} of '{}' has more than {} detections", frame + 1, found_.name, kMaxPerFrame),
        where);
  if (detection.track && std::any_of(list.begin(), list.end(), [&](const Detection& other) {
        return other.track == detection.track;
      }))
    throw Error(
        fmt::format(
            "track {} is in frame {} of '{}' twice", *detection.track, frame + 1, found_.name),
        where);
  list.push_back(std::move(detection));
}

}  // namespace airtruth::results
