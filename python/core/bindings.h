// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <airtruth/truth.h>
#include <pybind11/pybind11.h>

// The parts of the module airtruth._core, which is private: python/airtruth gives its functions
// their public form, annotations and pages.
namespace airtruth::python {

namespace py = pybind11;

void bind_lens(py::module_& core);
void bind_pictures(py::module_& core);
void bind_dataset(py::module_& core);
void bind_evaluate(py::module_& core);
void bind_clips(py::module_& core);
void bind_detectors(py::module_& core);
void bind_flights(py::module_& core);

// The arguments of airtruth.FrameTruth.
py::dict truth_dict(const FrameTruth& truth);
// A column for each field of an intruder, a row for each intruder and frame.
py::dict intruder_columns(const std::vector<FrameTruth>& frames);
// A column for each field of a frame but its intruders.
py::dict frame_columns(const std::vector<FrameTruth>& frames);

}  // namespace airtruth::python
