// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <airtruth/dataset.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "bindings.h"
#include "calls.h"
#include "values.h"

namespace airtruth::python {
namespace {

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
      .def(py::init<const std::filesystem::path&>())
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
}

}  // namespace airtruth::python
