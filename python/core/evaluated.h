// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <airtruth/average_precision.h>
#include <airtruth/box.h>
#include <pybind11/pybind11.h>

// Truth and answers from Python that several measures read.
namespace airtruth::python {

// ValueError where two arguments differ in their number of rows.
void expect_equal(std::size_t a, std::size_t b, const char* what);

// ValueError for a distance that is negative or not finite.
void checked_centre(double centre_px);

// A number for each of `count` boxes.
std::vector<double> beside(const pybind11::handle& value, const char* what, std::size_t count);

// Calls add(box, i) for each row that is a box.
template <typename Add>
void each_box(const std::vector<std::optional<Box>>& boxes, const Add& add) {
  for (std::size_t i = 0; i < boxes.size(); ++i)
    if (boxes[i]) add(*boxes[i], i);
}

// Truths as flagged in `ignored`, and after them the regions.
std::vector<evaluation::LabelledBox> labelled_boxes(const std::vector<std::optional<Box>>& truths,
                                                    const pybind11::handle& ignored,
                                                    const pybind11::handle& regions);

// The images of each sequence, as image_of() reads one of them; signals are seen.
template <typename Image>
auto sequences_of(const pybind11::list& sequences, const Image& image_of) {
  std::vector<std::vector<decltype(image_of(pybind11::handle()))>> result;
  for (const pybind11::handle& sequence : sequences) {
    result.emplace_back();
    for (const pybind11::handle& image : sequence.cast<pybind11::list>()) {
      if (PyErr_CheckSignals() != 0) throw pybind11::error_already_set();
      result.back().push_back(image_of(image));
    }
  }
  return result;
}

// An image from (truth n x 4, ignored n, regions k x 4, detections m x 4, scores m).
evaluation::ScoredImage scored_image_of(const pybind11::handle& item);

}  // namespace airtruth::python
