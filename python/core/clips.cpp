// SPDX-License-Identifier: Apache-2.0
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

// A value of each frame as a column.
template <typename Value>
py::array column(const std::vector<FrameMotion>& frames, Value value) {
  std::vector<decltype(value(frames[0]))> values;
  for (const FrameMotion& frame : frames) values.push_back(value(frame));
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
                const py::object& cache) {
  MotionOptions options;
  options.model = model;
  options.lens = lens;
  options.mask = mask;
  options.reference = reference;
  options.smoothing_s = smoothing_s;
  take_cache(cache, options);
  const ClipMotion found =
      stoppable(options, [&](const MotionOptions& o) { return measure_motion(video, o); });
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

}  // namespace

void bind_clips(py::module_& core) { core.def("motion", &motion); }

}  // namespace airtruth::python
