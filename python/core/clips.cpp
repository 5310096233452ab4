// SPDX-License-Identifier: Apache-2.0
#include <airtruth/calibration.h>
#include <airtruth/motion.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "bindings.h"
#include "calls.h"
#include "values.h"

namespace airtruth::python {
namespace {

namespace fs = std::filesystem;
using namespace py::literals;

py::object gyro_dict(const std::optional<GyroAgreement>& gyro) {
  if (!gyro) return py::none();
  return py::dict("correlation"_a = gyro->correlation,
                  "offset_s"_a = gyro->offset_s,
                  "rms_dps"_a = gyro->rms_dps);
}

py::dict motion(const py::kwargs& given) {
  MotionOptions options;
  const FromKeywords take{given};
  fs::path video;
  take("video", video);
  take("model", options.model);
  take("lens", options.lens);
  take("mask", options.mask);
  take("reference", options.reference);
  take("smoothing_s", options.smoothing_s);
  take("frame_rate_hz", options.frame_rate_hz);
  take_cache(given["cache"], options);
  const ClipMotion found = stoppable(
      options, [&](const MotionOptions& o) { return measure_motion(video, o); }, given["progress"]);
  const std::vector<FrameMotion>& frames = found.frames;
  const auto rotation = [](const FrameMotion& frame) { return *frame.cam_from_reference_cam; };
  return py::dict("width"_a = found.width,
                  "height"_a = found.height,
                  "lens"_a = found.lens,
                  "frame"_a = column(frames, &FrameMotion::frame),
                  "time_s"_a = column(frames, &FrameMotion::time_s),
                  "frame_from_reference"_a =
                      column(frames, &FrameMotion::frame_from_reference).attr("reshape")(-1, 3, 3),
                  "cam_from_reference_cam"_a = found.lens ? column(frames, rotation) : py::none(),
                  "inliers"_a = column(frames, &FrameMotion::inliers),
                  "rms_px"_a = column(frames, &FrameMotion::rms_px),
                  "state"_a = column(frames, &FrameMotion::state),
                  "gyro"_a = gyro_dict(found.gyro));
}

// One number of each estimate: a number, an array of three, or None.
py::object numbers_of(const std::vector<Estimate>& estimates, double Estimate::*number) {
  if (estimates.empty()) return py::none();
  if (estimates.size() == 1) return py::float_(estimates[0].*number);
  return column(estimates, number);
}

py::dict quantity_dict(const CalibratedQuantity& quantity) {
  return py::dict("value"_a = numbers_of(quantity.values, &Estimate::value),
                  "sigma"_a = numbers_of(quantity.values, &Estimate::sigma),
                  "missing"_a = text(quantity.missing),
                  "note"_a = text(quantity.note),
                  "source"_a = text(quantity.source),
                  "doubt"_a = text(quantity.doubt));
}

py::dict calibration(const py::kwargs& given) {
  CalibrateOptions options;
  const FromKeywords take{given};
  std::vector<fs::path> videos;
  take("videos", videos);
  take("lens", options.lens);
  take("mask", options.mask);
  take("altitude_m", options.altitude_m);
  take("heading_deg", options.heading_deg);
  take("gamma", options.gamma);
  take("profile", options.profile);
  take("frame_rate_hz", options.frame_rate_hz);
  const Calibration found = stoppable(
      options, [&](const CalibrateOptions& o) { return calibrate(videos, o); }, given["progress"]);
  py::dict quantities;
  for (const CalibratedQuantity& quantity : found.quantities)
    quantities[text(quantity.name)] = quantity_dict(quantity);
  return py::dict("width"_a = found.width,
                  "height"_a = found.height,
                  "frame_rate_hz"_a = found.frame_rate_hz,
                  "frames"_a = found.frames,
                  "clips"_a = found.clips,
                  "quantities"_a = quantities,
                  "readout_direction"_a = text(found.readout_direction),
                  "horizon_frame"_a = column(found.horizons, &HorizonAttitude::frame),
                  "horizon_pitch_deg"_a = column(found.horizons, &HorizonAttitude::pitch_deg),
                  "horizon_roll_deg"_a = column(found.horizons, &HorizonAttitude::roll_deg),
                  "no_horizon"_a = text(found.no_horizon),
                  "horizon_note"_a = text(found.horizon_note),
                  "toml"_a = text(found.toml));
}

py::list profiles() {
  py::list all;
  for (const CameraProfile& profile : camera_profiles())
    all.append(py::dict("name"_a = text(profile.name),
                        "camera"_a = text(profile.camera),
                        "width"_a = profile.width,
                        "height"_a = profile.height,
                        "clips"_a = profile.clips));
  return all;
}

}  // namespace

void bind_clips(py::module_& core) {
  core.def("motion", &motion);
  core.def("calibrate", &calibration);
  core.def("camera_profiles", &profiles);
}

}  // namespace airtruth::python
