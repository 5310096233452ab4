// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include <airtruth/average_precision.h>
#include <pybind11/pybind11.h>

// Truth and answers from Python that several measures read.
namespace airtruth::python {

// ValueError where two arguments differ in their number of rows.
void expect_equal(std::size_t a, std::size_t b, const char* what);

// ValueError for a distance that is negative or not finite.
void checked_centre(double centre_px);

// An image from (truth n x 4, ignored n, detections m x 4, scores m).
evaluation::ScoredImage scored_image_of(const pybind11::handle& item);

}  // namespace airtruth::python
