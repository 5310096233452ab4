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

// An image from (truth n x 4, ignored n, regions k x 4, detections m x 4, scores m).
evaluation::ScoredImage scored_image_of(const pybind11::handle& item);

}  // namespace airtruth::python
