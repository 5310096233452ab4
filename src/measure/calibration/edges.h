// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "foundation/geometry/transform.h"
#include "measure/calibration/calibration.h"
#include "measure/calibration/chroma.h"
#include "measure/calibration/step_response.h"

namespace airtruth::calibration {

// The camera's step response from the sharp straight edges of a clip: profiles across them to a
// fraction of a pixel (the slanted edge of ISO 12233). What is left of sharpness there is the
// lens's point spread, pixels and codec together, and what the world has; a bump on both sides of
// the step is sharpening. A bump on one side is a line in the world: such edges are left out.
class EdgeMeter {
 public:
  EdgeMeter(const image::Mask* own_aircraft, const image::ToneCurve& tone)
      : own_aircraft_(own_aircraft), tone_(tone) {}
  // frame_from_before: the picture's motion, which tells a sharp edge from a blurred one; empty:
  // not known.
  void add(const image::Picture& frame, const std::optional<Homography>& frame_from_before);

  // The spread's error holds that the sharpest of few edges may be soft in the world: edges of one
  // frame are different ones, those of other frames may be the same again, as those of one aircraft
  // before the sky are.
  // codec_step: of the quantiser, in code values; 0: none is known. A codec takes sharpness from
  // weak edges: where enough stand out from its step, they alone are taken.
  std::optional<StepResponse> result(std::string& why, double codec_step = 0);
  // What chroma has beyond luma across edges that are as sharp as `response`, which is of result()
  // with the same codec_step.
  std::optional<Estimate> chroma(const StepResponse& response,
                                 std::string& why,
                                 double codec_step = 0) const;
  const EdgeProfile& profile() const { return profile_; }

 private:
  struct Edge {
    double x = 0, y = 0;    // of the picture
    double nx = 0, ny = 0;  // across it
    double width_px = 0;    // standard deviation of its derivative
    double asymmetry = 0;   // rms height that its two halves differ by
    double height = 0;      // of the step, in code values
    double moved_px = 0;    // across itself, since the frame before; NaN: not known
    bool is_long = false;
    StepEdge step;
    std::vector<ChromaStep> chroma;
  };
  bool is_known(const Edge& edge) const;
  std::vector<const Edge*> usable(double codec_step) const;
  std::vector<const StepEdge*> sharp_ones(double codec_step) const;
  const image::Mask* own_aircraft_;
  image::ToneCurve tone_;
  std::vector<Edge> edges_;
  int most_at_once_ = 0;                 // edges in one frame
  std::size_t most_chroma_at_once_ = 0;  // those that show a step of colour too
  EdgeProfile profile_;
};

}  // namespace airtruth::calibration
