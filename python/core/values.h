// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <airtruth/box.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

// Values of the library as those of Python and NumPy, and numbers from Python with their checks.
namespace airtruth::python {

namespace py = pybind11;
using Doubles = py::array_t<double, py::array::c_style>;

// Numbers of Python as n x columns doubles. Throws TypeError where they are no real numbers, and
// ValueError for another shape; `what` names them in the message.
Doubles rows_of(const py::handle& value, const std::string& what, py::ssize_t columns);
// The same for a list of n numbers.
std::vector<double> list_of(const py::handle& value, const std::string& what);

// Boxes as rows x, y, width, height. Throws ValueError for a number that is infinite and for a
// negative size; a row that holds a NaN is no box.
std::vector<std::optional<Box>> boxes_of(const py::handle& value, const std::string& what);

// A size in pixels, 1 to 65536; ValueError for any other.
int size_of(std::int64_t value, const char* what);

// A text of the library, whose bytes need not be UTF-8 (names of files).
py::str text(const std::string& bytes);

// An array that owns the values: they are not copied.
template <typename T>
py::array array_of(std::vector<T> values, const std::vector<py::ssize_t>& shape) {
  auto kept = std::make_unique<std::vector<T>>(std::move(values));
  const T* data = kept->data();
  const py::capsule owner(kept.get(), [](void* p) { delete static_cast<std::vector<T>*>(p); });
  kept.release();
  return py::array_t<T>(shape, data, owner);
}

inline py::object python_of(bool value) { return py::bool_(value); }
inline py::object python_of(double value) { return py::float_(value); }
inline py::object python_of(int value) { return py::int_(value); }
inline py::object python_of(std::int64_t value) { return py::int_(value); }
inline py::object python_of(const std::string& value) { return text(value); }
inline py::object python_of(const Box& box) {
  return array_of<double>({box.x, box.y, box.width, box.height}, {4});
}
inline py::object python_of(const PixelBox& box) {
  return array_of<std::int64_t>({box.x, box.y, box.width, box.height}, {4});
}
template <std::size_t N>
py::object python_of(const std::array<double, N>& values) {
  return array_of(std::vector<double>(values.begin(), values.end()), {py::ssize_t{N}});
}
inline py::object python_of(const std::vector<double>& values) {
  return array_of(values, {std::ssize(values)});
}
template <typename T>
py::object python_of(const std::optional<T>& value) {
  return value ? python_of(*value) : py::object(py::none());
}

// Fills a dict: visit(name, value).
struct IntoDict {
  py::dict& dict;
  template <typename T>
  void operator()(const char* name, const T& value) const {
    dict[name] = python_of(value);
  }
};

}  // namespace airtruth::python
