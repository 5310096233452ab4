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

py::object gyro_dict(const std::optional<GyroAgreement>& gyro) {
  if (!gyro) return py::none();
  py::dict dict;
  const IntoDict into{dict};
  into("correlation", gyro->correlation);
  into("offset_s", gyro->offset_s);
  into("rms_dps", gyro->rms_dps);
  return dict;
}

// A value of each row as a column.
template <typename Row, typename Value>
py::array column(const std::vector<Row>& rows, Value value) {
  std::vector<decltype(value(rows[0]))> values;
  for (const Row& row : rows) values.push_back(value(row));
  const py::ssize_t count = std::ssize(values);
  return array_of(std::move(values), {count});
}

// The same of values of N numbers; `shape`: of one.
template <std::size_t N, typename Value>
py::array rows(const std::vector<FrameMotion>& frames,
               std::vector<py::ssize_t> shape,
               Value value) {
  std::vector<double> values;
  for (const FrameMotion& frame : frames) {
    const std::array<double, N>& row = value(frame);
    values.insert(values.end(), row.begin(), row.end());
  }
  shape.insert(shape.begin(), std::ssize(frames));
  return array_of(std::move(values), shape);
}

py::dict motion(const fs::path& video,
                const std::string& model,
                const fs::path& lens,
                const fs::path& mask,
                const std::string& reference,
                double smoothing_s,
                std::optional<double> frame_rate_hz,
                const py::object& cache,
                const py::object& progress) {
  MotionOptions options;
  options.model = model;
  options.lens = lens;
  options.mask = mask;
  options.reference = reference;
  options.smoothing_s = smoothing_s;
  options.frame_rate_hz = frame_rate_hz;
  take_cache(cache, options);
  const ClipMotion found = stoppable(
      options, [&](const MotionOptions& o) { return measure_motion(video, o); }, progress);
  const std::vector<FrameMotion>& frames = found.frames;
  py::dict dict;
  const IntoDict into{dict};
  into("width", found.width);
  into("height", found.height);
  dict["lens"] = found.lens;
  dict["frame"] = column(frames, [](const FrameMotion& f) { return f.frame; });
  dict["time_s"] = column(frames, [](const FrameMotion& f) { return f.time_s; });
  dict["frame_from_reference"] =
      rows<9>(frames, {3, 3}, [](const FrameMotion& f) { return f.frame_from_reference; });
  dict["cam_from_reference_cam"] =
      found.lens ? py::object(rows<4>(
                       frames, {4}, [](const FrameMotion& f) { return *f.cam_from_reference_cam; }))
                 : py::none();
  dict["inliers"] = column(frames, [](const FrameMotion& f) { return f.inliers; });
  dict["rms_px"] = column(frames, [](const FrameMotion& f) { return f.rms_px; });
  py::list states;
  for (const FrameMotion& frame : frames) states.append(frame.state);
  dict["state"] = states;
  dict["gyro"] = gyro_dict(found.gyro);
  return dict;
}

// One number of each estimate: a number, an array of three, or None.
py::object numbers_of(const std::vector<Estimate>& estimates, double Estimate::*number) {
  if (estimates.empty()) return py::none();
  if (estimates.size() == 1) return py::float_(estimates[0].*number);
  return column(estimates, [=](const Estimate& estimate) { return estimate.*number; });
}

py::dict quantity_dict(const CalibratedQuantity& quantity) {
  py::dict dict;
  const IntoDict into{dict};
  dict["value"] = numbers_of(quantity.values, &Estimate::value);
  dict["sigma"] = numbers_of(quantity.values, &Estimate::sigma);
  into("missing", quantity.missing);
  into("note", quantity.note);
  into("source", quantity.source);
  into("doubt", quantity.doubt);
  return dict;
}

py::dict calibration(const std::vector<fs::path>& videos,
                     const fs::path& lens,
                     const fs::path& mask,
                     std::optional<double> altitude_m,
                     double heading_deg,
                     double gamma,
                     const std::string& profile,
                     std::optional<double> frame_rate_hz,
                     const py::object& progress) {
  CalibrateOptions options;
  options.lens = lens;
  options.mask = mask;
  options.altitude_m = altitude_m;
  options.heading_deg = heading_deg;
  options.gamma = gamma;
  options.profile = profile;
  options.frame_rate_hz = frame_rate_hz;
  const Calibration found = stoppable(
      options, [&](const CalibrateOptions& o) { return calibrate(videos, o); }, progress);
  py::dict quantities;
  for (const CalibratedQuantity& quantity : found.quantities)
    quantities[text(quantity.name)] = quantity_dict(quantity);
  py::dict dict;
  const IntoDict into{dict};
  into("width", found.width);
  into("height", found.height);
  into("frame_rate_hz", found.frame_rate_hz);
  into("frames", found.frames);
  into("clips", found.clips);
  dict["quantities"] = quantities;
  into("readout_direction", found.readout_direction);
  dict["horizon_frame"] = column(found.horizons, [](const auto& h) { return h.frame; });
  dict["horizon_pitch_deg"] = column(found.horizons, [](const auto& h) { return h.pitch_deg; });
  dict["horizon_roll_deg"] = column(found.horizons, [](const auto& h) { return h.roll_deg; });
  into("no_horizon", found.no_horizon);
  into("horizon_note", found.horizon_note);
  into("toml", found.toml);
  return dict;
}

py::list profiles() {
  py::list all;
  for (const CameraProfile& profile : camera_profiles()) {
    py::dict dict;
    const IntoDict into{dict};
    into("name", profile.name);
    into("camera", profile.camera);
    into("width", profile.width);
    into("height", profile.height);
    into("clips", profile.clips);
    all.append(dict);
  }
  return all;
}

}  // namespace

void bind_clips(py::module_& core) {
  core.def("motion",
           named(&motion,
                 "video",
                 "model",
                 "lens",
                 "mask",
                 "reference",
                 "smoothing_s",
                 "frame_rate_hz",
                 "cache",
                 "progress"));
  core.def("calibrate",
           named(&calibration,
                 "videos",
                 "lens",
                 "mask",
                 "altitude_m",
                 "heading_deg",
                 "gamma",
                 "profile",
                 "frame_rate_hz",
                 "progress"));
  core.def("camera_profiles", &profiles);
}

}  // namespace airtruth::python
