// SPDX-License-Identifier: Apache-2.0
#include "calibration/optics/edges.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include <opencv2/imgproc.hpp>

#include "calibration/optics/chroma.h"
#include "camera/motion/corners.h"
#include "foundation/geometry/transform.h"
#include "foundation/image/colour.h"

namespace airtruth::optics {
namespace {

// Where a constant of this file states no origin, it was chosen on the virtual flights of
// camera_slow_test.cpp, whose figures are in docs/realism.md.

// Number of long edges from which on only long ones are used.
constexpr std::size_t kMinLong = 60;
// Number of edges that are kept: of one frame, of the clip, and the least number for a result.
constexpr int kMaxPerFrame = 60;
constexpr std::size_t kMaxEdges = 6000;
constexpr std::size_t kMinEdges = 12;
// Least distance between two edges of a frame, px.
constexpr int kMinDistancePx = 8;
// Largest width of an edge, as a multiple of that of the sharpest one. Only the most symmetric of
// these are used, since a line along one side of an edge looks like half an unsharp mask.
constexpr double kMaxWidthRatio = 1.4;
// Share of the edges that count as most symmetric, the least number of them, and the largest number
// that is fitted, which bounds the time.
constexpr double kSymmetricShare = 0.25;
constexpr std::size_t kMinSymmetric = 60;
constexpr std::size_t kMaxFitted = 150;
// Least height of an edge, in steps of the codec's quantiser, at which quantisation does not change
// its sharpness. In a transform of 8 x 8 samples a step of height h through a spread of 0.7 px has
// a coefficient of 0.55 h at a quarter of a cycle a pixel (closed form of the DCT-II); half a
// quantiser's step is a sixth of that.
constexpr double kMinHeightInCodecSteps = 6;
// Largest motion across an edge between frames, px. Faster edges are blurred by motion.
constexpr double kMaxMotionPx = 10;
// Edges within this distance, px, and this cosine of their directions (2 degrees) are one edge.
constexpr double kMaxOffsetOfSamePx = 1;
constexpr double kMinCosineOfSame = 0.9994;
// Mean relative excess of the spread of edges in the world over the sharpest. The sharpest of n
// different edges exceeds the camera's spread by 1 / n of it: the expected minimum of n exponential
// values.
constexpr double kMeanExcessInWorld = 0.7;
// Largest width of an edge that the camera limits, as a multiple of that of the sharpest one.
// Softer edges are soft in the world. Of clips that were blurred on purpose 0.2 to 0.7 of the edges
// are that narrow, of other real clips 0.04 to 0.13 but for one.
constexpr double kLimitedWidthRatio = 1.2;

double moved_across(const EdgeLine& line, const Homography& frame_from_before) {
  const Pixel here(line.x + 0.5, line.y + 0.5);
  const Pixel before = apply(frame_from_before.inverse(), here);
  return std::abs((here.x() - before.x()) * line.nx + (here.y() - before.y()) * line.ny);
}

}  // namespace

void EdgeMeter::add(const image::Picture& frame,
                    const std::optional<Homography>& frame_from_before) {
  if (edges_.size() >= kMaxEdges) return;
  const cv::Mat grey = motion::luma_of(frame);
  const image::ColourCode code(frame.colour);
  const double dark = double(code.ycc_from_rgb({0, 0, 0}).y);
  const double unit = double(code.ycc_from_rgb({1, 1, 1}).y) - dark;
  cv::Mat taken(grey.size(), CV_8UC1, cv::Scalar(0));
  int count = 0;
  std::size_t with_chroma = 0;
  for (const SteepPlace& place : steep_places(grey)) {
    if (count >= kMaxPerFrame) break;
    const cv::Point at = place.at;
    if (taken.at<unsigned char>(at) != 0) continue;
    auto found = straight_step_at(grey, place);
    const double half_length = found ? found->line.half_length_px : 0;
    const cv::Point along = found ? cv::Point(static_cast<int>(half_length * found->line.ny),
                                              static_cast<int>(-half_length * found->line.nx))
                                  : cv::Point(0, 0);
    cv::line(taken, at - along, at + along, cv::Scalar(255), 2 * kMinDistancePx);
    if (!found) continue;
    // Edges of the own aircraft are as useful for sharpness as others; the mask shows that they do
    // not move.
    const bool own = own_aircraft_ != nullptr && !own_aircraft_->is_free(at.x, at.y);
    Edge edge{std::move(*found)};
    edge.height = edge.step.high - edge.step.low;
    for (double* level : {&edge.step.low, &edge.step.high}) *level = (*level - dark) / unit;
    edge.moved_px = own                 ? 0
                    : frame_from_before ? moved_across(edge.line, *frame_from_before)
                                        : std::numeric_limits<double>::quiet_NaN();
    if (is_known(edge)) continue;
    edge.chroma = chroma_variances(frame, edge.line);
    with_chroma += edge.chroma.empty() ? 0 : 1;
    edges_.push_back(std::move(edge));
    ++count;
  }
  most_at_once_ = std::max(most_at_once_, count);
  most_chroma_at_once_ = std::max(most_chroma_at_once_, with_chroma);
}

bool EdgeMeter::is_known(const Edge& edge) const {
  return std::any_of(edges_.begin(), edges_.end(), [&](const Edge& known) {
    const EdgeLine &a = edge.line, &b = known.line;
    const double dx = a.x - b.x, dy = a.y - b.y;
    return std::abs(dx * b.nx + dy * b.ny) < kMaxOffsetOfSamePx &&
           std::hypot(dx, dy) < 2 * kLongEdgePx && a.nx * b.nx + a.ny * b.ny > kMinCosineOfSame;
  });
}

std::vector<const EdgeMeter::Edge*> EdgeMeter::usable(double codec_step) const {
  std::vector<const Edge*> all, slow, clear, long_ones;
  for (const Edge& edge : edges_) {
    all.push_back(&edge);
    if (edge.moved_px > kMaxMotionPx) continue;
    slow.push_back(&edge);
    if (edge.height >= kMinHeightInCodecSteps * codec_step) clear.push_back(&edge);
  }
  if (slow.size() < kMinEdges) return all;
  const std::vector<const Edge*>& chosen = clear.size() >= kMinSymmetric ? clear : slow;
  std::copy_if(chosen.begin(), chosen.end(), std::back_inserter(long_ones), [](const Edge* edge) {
    return edge->line.half_length_px == kLongEdgePx;
  });
  return long_ones.size() >= kMinLong ? long_ones : chosen;
}

std::vector<const EdgeMeter::Edge*> EdgeMeter::by_width(double codec_step) const {
  std::vector<const Edge*> edges = usable(codec_step);
  std::sort(edges.begin(), edges.end(), [](const Edge* a, const Edge* b) {
    return a->width_px < b->width_px;
  });
  // The sharpest hundredth is dropped: these edges are accidentally narrower than the camera's.
  edges.erase(edges.begin(), edges.begin() + static_cast<std::ptrdiff_t>(edges.size() / 100));
  return edges;
}

double EdgeMeter::share_limited(const std::vector<const Edge*>& by_width) {
  const double widest_px = kLimitedWidthRatio * by_width[0]->width_px;
  const auto count = std::count_if(by_width.begin(), by_width.end(), [&](const Edge* edge) {
    return edge->width_px <= widest_px;
  });
  return double(count) / double(by_width.size());
}

std::vector<const StepEdge*> EdgeMeter::sharp_ones(std::vector<const Edge*> edges) {
  const auto keep = [&](std::size_t count, std::size_t fewest) {
    edges.resize(std::min(edges.size(), std::max(count, fewest)));
  };
  const auto narrower_than = [&](double width_px) {
    return static_cast<std::size_t>(std::count_if(
        edges.begin(), edges.end(), [&](const Edge* edge) { return edge->width_px < width_px; }));
  };
  const auto by_asymmetry = [](const Edge* a, const Edge* b) {
    return a->asymmetry < b->asymmetry;
  };
  keep(narrower_than(kMaxWidthRatio * edges[0]->width_px), kMinSymmetric);
  std::sort(edges.begin(), edges.end(), by_asymmetry);
  keep(static_cast<std::size_t>(kSymmetricShare * double(edges.size())), kMinSymmetric);
  edges.resize(std::min(edges.size(), kMaxFitted));
  std::vector<const StepEdge*> sharp;
  for (const Edge* edge : edges) sharp.push_back(&edge->step);
  return sharp;
}

Measured<StepResponse> EdgeMeter::result(double codec_step) {
  if (edges_.size() < kMinEdges)
    return NotMeasured{"the clip shows " + std::to_string(edges_.size()) +
                       " clean straight edges; it takes " + std::to_string(kMinEdges)};
  const std::vector<const Edge*> sharpest_first = by_width(codec_step);
  const auto edges = sharp_ones(sharpest_first);
  StepResponse response = fit_step_response(edges, tone_);
  Estimate& spread = response.point_spread_px;
  const double limited = share_limited(sharpest_first) * most_at_once_;
  spread.sigma = std::hypot(spread.sigma, spread.value * kMeanExcessInWorld / limited);
  profile_ = edge_profile(edges, response, tone_);
  return response;
}

Measured<Estimate> EdgeMeter::chroma(const StepResponse& response, double codec_step) const {
  std::vector<LumaAndChroma> both;
  for (const Edge* edge : usable(codec_step))
    if (!edge->chroma.empty()) both.push_back({&edge->step, &edge->chroma});
  return chroma_spread(both, most_chroma_at_once_, response, tone_);
}

}  // namespace airtruth::optics
