// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <airtruth/dataset.h>
#include <airtruth/labels.h>
#include <airtruth/video.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "bindings.h"
#include "calls.h"
#include "values.h"

namespace airtruth::python {
namespace {

namespace fs = std::filesystem;
using namespace py::literals;
using exchange::Clip;

py::object mask_dict(const std::optional<exchange::PixelMask>& mask) {
  if (!mask) return py::none();
  return py::dict("size"_a = py::make_tuple(mask->height, mask->width),
                  "counts"_a = text(mask->counts));
}

py::dict label_dict(const exchange::Label& label) {
  py::dict dict;
  dict["track"] = label.track;
  dict["category"] = text(label.category);
  dict["box_px"] = python_of(label.box_px);
  dict["visible"] = label.visible;
  dict["occluded"] = label.occluded;
  dict["truncated"] = label.truncated;
  dict["range_m"] = label.range_m;
  dict["above_horizon"] = label.above_horizon;
  dict["contrast_to_noise"] = label.contrast_to_noise;
  dict["area_px"] = label.area_px;
  dict["object_class"] = text(label.object_class);
  dict["mask"] = mask_dict(label.mask);
  return dict;
}

// The arguments of airtruth.Clip.
py::dict clip_dict(const Clip& clip) {
  py::list frames;
  for (const exchange::LabelledFrame& frame : clip.frames) {
    py::dict one;
    one["frame"] = frame.frame;
    one["time_s"] = frame.time_s;
    one["picture"] = text(frame.picture);
    py::list labels;
    for (const exchange::Label& label : frame.labels) labels.append(label_dict(label));
    one["labels"] = labels;
    frames.append(one);
  }
  return py::dict("name"_a = text(clip.name),
                  "width"_a = clip.width,
                  "height"_a = clip.height,
                  "frame_rate_hz"_a = clip.frame_rate_hz,
                  "media"_a = clip.media,
                  "frames"_a = frames);
}

// Clips as Python holds them: the library's own, which it can write again.
struct PyClips {
  std::vector<Clip> clips;
};

std::pair<int, int> size_of_picture(const fs::path& picture) {
  const VideoInfo info = VideoReader(picture).info();
  return {info.width, info.height};
}

PyClips clips_in(const std::string& format,
                 const fs::path& source,
                 const std::optional<std::pair<py::object, py::object>>& size,
                 const std::string& category) {
  if (format == "airtruth") return {{exchange::read_labels(source)}};
  exchange::ReadOptions options;
  if (size) options.size = {size_of(size->first, "width"), size_of(size->second, "height")};
  options.category = category;
  options.size_of_picture = &size_of_picture;
  Warnings warnings;
  PyClips found{left_alone([=, warn = warnings.taker()] {
    return exchange::read_clips(exchange::format_from_name(format), source, options, warn);
  })};
  warnings.hand_over();
  return found;
}

void write(const std::string& format,
           const fs::path& folder,
           const std::string& part,
           const py::object& clips) {
  const exchange::Part written{part, clips.cast<const PyClips&>().clips};
  const GilReleased released;
  exchange::write_clips(exchange::format_from_name(format), folder, {&written, 1});
}

py::list dicts(const PyClips& clips) {
  py::list result;
  for (const Clip& clip : clips.clips) result.append(clip_dict(clip));
  return result;
}

dataset::Boxes boxes_from_name(const std::string& name) {
  if (name == "covered") return dataset::Boxes::kCovered;
  if (name == "exact") return dataset::Boxes::kExact;
  if (name == "visible") return dataset::Boxes::kVisible;
  throw py::value_error("boxes is '" + name.substr(0, 80) +
                        "'; expected 'covered', 'exact' or 'visible'");
}

// What labels tell of an intruder.
IntruderTruth intruder_of(const exchange::Label& label) {
  IntruderTruth intruder;
  intruder.id = std::to_string(label.track);
  intruder.aircraft = label.category;
  intruder.object_class = label.object_class;
  intruder.state = IntruderState::kVisible;
  intruder.exact_box_px = label.box_px;
  intruder.range_m = label.range_m;
  intruder.contrast_to_noise = label.contrast_to_noise;
  return intruder;
}

// The truth of each frame; that of an imported clip is what its labels tell.
std::vector<FrameTruth> truth_of(const Sequence& sequence) {
  if (sequence.truth) return sequence.truth->frames;
  std::vector<FrameTruth> frames;
  for (const exchange::LabelledFrame& labelled : sequence.labels.frames) {
    FrameTruth& frame = frames.emplace_back();
    frame.frame = labelled.frame;
    frame.time_s = sequence.labels.time_s_of(labelled).value_or(std::nan(""));
    frame.motion_state = "none";
    for (const exchange::Label& label : labelled.labels)
      frame.intruders.push_back(intruder_of(label));
  }
  return frames;
}

// A sequence as it was read. Nothing of it is open.
struct PySequence {
  explicit PySequence(Sequence read) : sequence(std::move(read)), frames(truth_of(sequence)) {}

  py::dict truth(std::int64_t row) const {
    if (row < 0 || row >= std::ssize(frames)) throw py::index_error("there is no such frame");
    return truth_dict(frames[static_cast<std::size_t>(row)]);
  }
  std::optional<Lens> lens() const {
    return sequence.truth ? std::optional(sequence.truth->lens) : std::nullopt;
  }

  Sequence sequence;
  std::vector<FrameTruth> frames;
};

PySequence sequence_in(const DataSet& set, const std::string& name, const std::string& boxes) {
  const dataset::Boxes wanted = boxes_from_name(boxes);
  return left_alone([=] { return PySequence(set.sequence(name, wanted)); });
}

}  // namespace

void bind_dataset(py::module_& core) {
  py::class_<DataSet>(core, "DataSet")
      .def(py::init<const fs::path&>())
      .def_property_readonly("names", &DataSet::names)
      .def("sequence", named(&sequence_in, "self", "name", "boxes"));
  py::class_<PySequence>(core, "Sequence")
      .def_property_readonly("name", [](const PySequence& s) { return s.sequence.name; })
      .def_property_readonly("folder", [](const PySequence& s) { return s.sequence.folder; })
      .def_property_readonly("video", [](const PySequence& s) { return s.sequence.video; })
      .def_property_readonly("is_imported",
                             [](const PySequence& s) { return s.sequence.is_imported; })
      .def_property_readonly("lens", &PySequence::lens)
      .def_property_readonly("labels",
                             [](const PySequence& s) { return clip_dict(s.sequence.labels); })
      .def_property_readonly("length", [](const PySequence& s) { return s.frames.size(); })
      .def("truth", &PySequence::truth)
      .def("intruder_columns", [](const PySequence& s) { return intruder_columns(s.frames); })
      .def("frame_columns", [](const PySequence& s) { return frame_columns(s.frames); });
  py::class_<PyClips>(core, "Clips").def("dicts", &dicts);
  core.def("read_clips", named(&clips_in, "format", "source", "size", "category"));
  core.def("write_clips", named(&write, "format", "folder", "part", "clips"));
}

}  // namespace airtruth::python
