// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "calibration/measured/measured.h"
#include "calibration/optics/step_response.h"
#include "calibration/optics/straight_step.h"
#include "foundation/geometry/transform.h"
#include "foundation/image/layer.h"
#include "foundation/image/picture.h"
#include "foundation/image/tone_curve.h"

namespace airtruth::optics {

// Measures the camera's step response from the sharp straight edges of a clip. It samples the
// profiles across them to a fraction of a pixel (the slanted-edge method of ISO 12233). The width
// of a profile comes from the lens's point spread, the pixels and the codec together, and from the
// softness of the edge in the world. An overshoot on both sides of the step is sharpening. An
// overshoot on one side is a line in the world, and such edges are left out.
class EdgeMeter {
 public:
  EdgeMeter(const image::Mask* own_aircraft, const image::ToneCurve& tone)
      : own_aircraft_(own_aircraft), tone_(tone) {}
  // Adds the edges of one frame. `frame_from_before`: motion of the picture since the previous
  // frame, by which edges blurred by motion are recognised; empty if it is not known.
  void add(const image::Picture& frame, const std::optional<Homography>& frame_from_before);

  // The step response of the camera. Not measured where there are too few sharp edges.
  //
  // The error of the spread includes the chance that the sharpest edges are soft in the world. It
  // follows from the number of different edges that are nearly as sharp as the sharpest: many of
  // them are limited by the camera, a single one may be of a soft thing. Different edges are those
  // of one frame: the edges of other frames may be the same ones again, as those of one aircraft
  // against the sky are.
  //
  // The spread along the rows and along the columns is by edges that lie within 30 degrees of the
  // columns and of the rows. A picture of two fields made whole (deinterlaced) is softer along its
  // columns, and so is one scaled up in height alone. The vertical spread is 0 where the difference
  // of the two variances is below twice its error, and not measured where either kind has fewer
  // than 12 edges; edges of all directions then give the point spread.
  //
  // `codec_step`: step of the codec's quantiser in code values; 0 if it is not known. Quantisation
  // softens weak edges. Where enough edges are high compared with the step, only those are used.
  Measured<StepResponse> result(double codec_step = 0);
  // The extra spread of chroma beyond luma, a standard deviation in luma pixels: the square root of
  // the median difference between the variances of chroma and luma across the same edges, those
  // that are nearly as sharp as `response`, the answer of result() with the same `codec_step`.
  // Cameras and codecs keep less colour detail than the grid of chroma samples could hold: on the
  // clips of data/camera-profiles, edges that luma crosses within 2 px are 6 to 9 px wide in Cb and
  // Cr. The error is the scatter of the differences divided by the square root of the largest
  // number of such edges in one frame. Not measured where there are fewer than 12 steps.
  Measured<Estimate> chroma(const StepResponse& response, double codec_step = 0) const;
  // The mean profile of the edges that the last result() used.
  const EdgeProfile& profile() const { return profile_; }

 private:
  // A step whose levels are coded luma, 0 to 1.
  struct Edge : StraightStep {
    double height = 0;    // of the step, code values
    double moved_px = 0;  // motion across the edge since the previous frame; NaN: not known
    std::vector<double> chroma = {};  // chroma_variances()
  };
  // Whether the edge was added before. An edge that stays at its place in the picture, such as one
  // of the own aircraft, is the same edge in all frames.
  bool is_known(const Edge& edge) const;
  std::vector<const Edge*> usable(double codec_step) const;
  // The edges, the sharpest first.
  static std::vector<const Edge*> by_width(std::vector<const Edge*> edges);
  // Parts the spread along the columns from that along the rows.
  void part_by_axis(StepResponse& response, const std::vector<const Edge*>& edges) const;
  // The spread of the camera by these edges under a mask that is known, with its error.
  Estimate spread_by(const std::vector<const Edge*>& by_width, const StepResponse& mask) const;
  static std::vector<const StepEdge*> sharp_ones(std::vector<const Edge*> by_width);
  // The share of edges that are nearly as sharp as the sharpest.
  static double share_limited(const std::vector<const Edge*>& by_width);
  const image::Mask* own_aircraft_;
  image::ToneCurve tone_;
  std::vector<Edge> edges_;
  // The largest number of edges in one frame, and of those with a step of chroma.
  int most_at_once_ = 0;
  std::size_t most_chroma_at_once_ = 0;
  EdgeProfile profile_;
};

}  // namespace airtruth::optics
